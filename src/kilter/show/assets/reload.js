"use strict";
(() => {
  // reload the page when the server that delivered it has a newer version
  let known = null;
  const ask = async () => {
    try {
      const answer = await fetch("/version", { cache: "no-store" });
      const version = await answer.text();
      if (answer.ok && known !== null && version !== known) location.reload();
      if (answer.ok) known = version;
    } catch {
      // the server has stopped; the page stays as it is
    }
  };
  ask();
  setInterval(ask, 700);
})();
