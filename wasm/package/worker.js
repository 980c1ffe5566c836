// Simulates for index.js in a thread of its own, in browsers and in node.
import { load, loadWithLists } from "./core.js";

const port = globalThis.process?.versions?.node
  ? (await import("node:worker_threads")).parentPort
  : globalThis;

function buffersOf(value) {
  if (ArrayBuffer.isView(value)) return [value.buffer];
  return value && typeof value === "object" ? Object.values(value).flatMap(buffersOf) : [];
}

function answer(message) {
  port.postMessage(message, buffersOf(message.run));
}

// Each module is compiled when it is first needed.
let forOne, forLists;
function simulatorFor(scene) {
  let listed = false;
  try {
    listed = "dampers" in JSON.parse(scene);
  } catch {
    // No scene: what is wrong with it is for either module to say.
  }
  return listed ? (forLists ??= loadWithLists()) : (forOne ??= load());
}

const listen = async ({ data }) => {
  try {
    const simulator = await simulatorFor(data.scene);
    answer({ run: simulator.simulate(data.scene, data.options) });
  } catch (error) {
    answer({ error: { kind: error.kind, message: error.message } });
  }
};
if (port === globalThis) port.onmessage = listen;
else port.on("message", (data) => listen({ data }));
