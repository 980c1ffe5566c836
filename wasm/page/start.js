// The page's worker, made of what the page holds: nothing is asked for outside, so it opens from a folder.
const text = (id) => document.getElementById(id).textContent;

function simulateInWorker() {
  const worker = new Worker(URL.createObjectURL(new Blob([text("worker")], { type: "text/javascript" })));
  worker.postMessage({ module: Uint8Array.from(atob(text("module")), (letter) => letter.charCodeAt(0)) });
  return (scene, options) =>
    new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.run ? resolve(data.run) : reject(new Error(data.error)));
      worker.onerror = (event) => reject(new Error(event.message));
      worker.postMessage({ scene, options });
    });
}

mountDamper(document.querySelector("#damper"), simulateInWorker());
