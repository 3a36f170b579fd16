// Search in a site opened from a folder: browsers refuse workers there, a hidden frame does as well.
// The name tells the theme that it need not ask another host for one.
if (location.protocol === "file:") {
  const run = (document, url) => {
    return new Promise((done, failed) => {
      const script = document.createElement("script");
      Object.assign(script, { src: url, onload: done, onerror: failed });
      document.head.append(script);
    });
  };

  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      const inside = this.frame.contentWindow;
      const told = (name, data) => this.dispatchEvent(new MessageEvent(name, { data }));
      // what the worker's program says goes out; scripts that it imports run in their order
      inside.postMessage = (data) => told("message", data);
      inside.importScripts = (...urls) => urls.reduce(
        (before, one) => before.then(() => run(inside.document, one)), Promise.resolve(),
      );
      this.ready = run(inside.document, url);
    }

    postMessage(data) {
      const inside = this.frame.contentWindow;
      this.ready.then(() => inside.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
