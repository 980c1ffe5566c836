// Simulations in a thread of their own, one after the other; one that is no longer wanted is ended with its thread.
import { ImpactDamperError } from "./core.js";

export { ImpactDamperError };

async function startWorker(address) {
  if (!globalThis.process?.versions?.node) return new Worker(address, { type: "module" });
  const { Worker: NodeWorker } = await import("node:worker_threads");
  const worker = new NodeWorker(address);
  // The interface of a browser's worker, as far as it is used here.
  worker.on("message", (data) => worker.onmessage({ data }));
  worker.on("error", (error) => worker.onerror(error));
  return worker;
}

let worker; // a promise of one
let last = Promise.resolve(); // the call before

function endWorker() {
  worker?.then((each) => each.terminate());
  worker = undefined;
}

async function ask(message, signal) {
  signal?.throwIfAborted();
  const here = await (worker ??= startWorker(new URL("./worker.js", import.meta.url)));
  here.ref?.(); // node ends when nothing but an idle worker is left
  let stop;
  try {
    return await new Promise((resolve, reject) => {
      stop = () => {
        endWorker();
        reject(signal.reason);
      };
      if (signal?.aborted) stop();
      signal?.addEventListener("abort", stop);
      here.onmessage = ({ data }) =>
        data.run ? resolve(data.run) : reject(new ImpactDamperError(data.error.kind, data.error.message));
      here.onerror = (error) => {
        endWorker();
        reject(new Error(`the simulation's thread ended: ${error.message}`));
      };
      here.postMessage(message);
    });
  } finally {
    signal?.removeEventListener("abort", stop);
    here.unref?.();
  }
}

const asText = (value) => (typeof value === "string" ? value : JSON.stringify(value));

/** Runs a scene: see index.d.ts. */
export function run(scene, { signal, engine = "exact", ...options } = {}) {
  const message = { scene: asText(scene), options: { ...options, engine: asText(engine) } };
  const result = last.then(() => ask(message, signal));
  last = result.catch(() => {});
  return result;
}
