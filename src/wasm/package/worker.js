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

// Promises of the two modules, each compiled for the first scene that needs it: the smaller one knows scenes of one damper
// only, the larger one also those whose key "dampers" is a list of several.
let forOne, forLists;
function simulatorFor(scene) {
  let listed = false;
  try {
    listed = "dampers" in JSON.parse(scene);
  } catch {
    // No JSON object, so no scene: the smaller module says what is wrong with it.
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
