// What all that runs in a page has in common: its elements, and its workers.

/** An element of a page or of a drawing. */
function make(tag, attributes = {}, ...children) {
  const drawn = ["svg", "g", "path", "rect", "circle", "line", "text"].includes(tag);
  const element = drawn ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Puts what open(place) makes of a place behind a button that has the words of the place's data-words. */
function openByButton(place, open) {
  const button = make("button", { type: "button", class: "open-damper" }, place.dataset.words);
  button.addEventListener("click", () => {
    open(place);
    place.querySelector("input, select").focus({ preventScroll: true });
  });
  place.append(button);
}

const textOf = (id) => document.getElementById(id).textContent.trim();
const bytesOf = (id) => Uint8Array.from(atob(textOf(id)), (letter) => letter.charCodeAt(0));

/**
 * Starts a worker of the script that the page holds under `id`; its first message is first(). Returns ask(request, tell), a
 * promise of the answer; requests are worked on in their order. ask.end() ends the worker, and nothing is answered any more.
 */
function startWorker(id, first) {
  const waiting = [];
  let broken;
  const fail = (message) => {
    broken = new Error(message || "the browser does not let this page start a worker: try another browser");
    waiting.splice(0).forEach(({ reject }) => reject(broken));
  };
  let worker;
  try {
    worker = new Worker(URL.createObjectURL(new Blob([textOf(id)], { type: "text/javascript" })));
    worker.onmessage = ({ data }) => {
      if (data.progress) return waiting[0].tell(data.progress);
      const { resolve, reject } = waiting.shift();
      if (data.error === undefined) resolve(data.answer);
      else reject(new Error(data.error));
    };
    worker.onerror = (event) => fail(event.message);
    worker.postMessage(first());
  } catch (error) {
    fail(error.message);
  }
  const ask = (request, tell = () => {}) =>
    new Promise((resolve, reject) => {
      if (broken) return reject(broken);
      waiting.push({ tell, resolve, reject });
      worker.postMessage(request);
    });
  ask.end = () => worker?.terminate();
  return ask;
}
