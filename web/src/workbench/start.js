// The start page: files of the folder, examples, and files that are dropped or chosen.

import { id, on } from "../dom.js";
import { button } from "./entries.js";

export class Start {
  constructor(bench) {
    this.bench = bench;
    this.asked = false;
    on("open-file", "click", () => this.show(true));
    on("end-start", "click", () => this.show(false));
    for (const name of ["files", "folder"]) {
      on(name, "change", () => {
        this.upload([...id(name).files].map((file) => ({ file, folder: file.webkitRelativePath.split("/").slice(0, -1)[0] || "" })));
        id(name).value = "";
      });
    }
    const over = (event, on_) => {
      if (![...(event.dataTransfer?.types ?? [])].includes("Files")) return;
      event.preventDefault();
      id("drop").classList.toggle("over", on_);
    };
    document.addEventListener("dragover", (e) => over(e, true));
    document.addEventListener("dragleave", (e) => over(e, false));
    document.addEventListener("drop", async (e) => {
      over(e, false);
      this.upload(await dropped(e.dataTransfer));
    });
  }

  /** Show or hide the start page, also while a file is open. */
  show(asked) {
    this.asked = asked;
    this.tell(this.bench.session);
    if (asked) id("files").focus();
  }

  tell(session) {
    const open = Boolean(session.file);
    id("start").hidden = open && !this.asked;
    id("end-start").hidden = !open;
    id("open-file").hidden = !open;
    id("listed-folder").textContent = session.folder;
    id("listed-title").hidden = !session.files.length;
    this.list("listed", session.files, "file");
    this.list("examples", session.examples, "example");
    const recent = session.recent.filter(({ name }) => !session.files.includes(name));
    id("recent-title").hidden = !recent.length;
    this.list("recent", recent.map(({ path }) => path), "recent");
    this.feature(session.featured);
    id("missing").replaceChildren(
      ...session.missing.map((sentence) => {
        const item = document.createElement("li");
        item.textContent = sentence;
        return item;
      }),
    );
  }

  list(name, words, kind) {
    const now = words.join("\n");
    if (id(name).dataset.words === now) return; // keeps the focus
    id(name).dataset.words = now;
    id(name).replaceChildren(
      ...words.map((word) => {
        const item = document.createElement("li");
        item.append(button(word.split("/").pop(), () => this.open({ [kind]: word }), kind === "recent" ? word : ""));
        return item;
      }),
    );
  }

  /** Show some examples with a picture and a sentence. */
  feature(featured) {
    if (id("featured").childElementCount) return;
    id("featured").append(
      ...Object.entries(featured).map(([name, words]) => {
        const item = document.createElement("li");
        const card = button("", () => this.open({ example: name }));
        const [picture, title] = [document.createElement("span"), document.createElement("span")];
        picture.className = "thumbnail";
        title.textContent = words;
        card.append(picture, title);
        item.append(card);
        this.draw(picture, name);
        return item;
      }),
    );
  }

  /** Fill a box with the picture of an example. */
  async draw(box, name) {
    const response = await fetch(this.bench.link.address(`picture/${name}`));
    if (!response.ok) return;
    const svg = new DOMParser().parseFromString(await response.text(), "image/svg+xml").documentElement;
    svg.setAttribute("aria-hidden", "true");
    box.replaceChildren(document.importNode(svg, true));
  }

  async open(what) {
    const reply = await this.bench.act({ do: "open", ...what });
    if (reply.ok) this.show(false);
  }

  /** Send files to the server, and open the first, or their folder. */
  async upload(list) {
    if (!list.length) return;
    let opened = null;
    for (const [k, { file, folder }] of list.entries()) {
      id("upload").textContent = `${file.name}: file ${k + 1} of ${list.length} is being sent`;
      const more = folder ? { name: file.name, folder } : { name: file.name };
      try {
        const response = await fetch(this.bench.link.address("upload", more), { method: "POST", body: file });
        const data = await response.json();
        if (!response.ok) throw new Error(sentence(data));
        opened ??= data.file;
      } catch (error) {
        id("upload").textContent = "";
        this.bench.complain(`${file.name} was not sent: ${error.message}`);
        return;
      }
    }
    id("upload").textContent = "";
    await this.open({ file: opened });
  }
}

/** An error of the server as a sentence, with its hint. */
export const sentence = ({ error, hint }) => (hint ? `${error}: ${hint}` : error);

/** The files of a drop: {file, folder}; the files in a folder and its folders. */
async function dropped(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.length) return [...transfer.files].map((file) => ({ file, folder: "" }));
  const found = [];
  for (const entry of entries) await collect(entry, "", found);
  return found;
}

async function collect(entry, folder, found) {
  if (entry.isFile) {
    const file = await new Promise((done, fail) => entry.file(done, fail));
    found.push({ file, folder });
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    const batch = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (!batch.length) return;
    for (const child of batch) if (child.isFile) await collect(child, folder || entry.name, found);
  }
}
