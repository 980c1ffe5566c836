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
// without friction, weight and drag, and without laws of walls and springs, the larger one all.
let forOne, forAll;
const ofAll = /^(dampers|wall|spring|weight|inclination|drag|(static_)?friction(_coefficient)?)$/;
function simulatorFor(scene) {
  let keys = [];
  try {
    keys = Object.keys(JSON.parse(scene));
  } catch {
    // No JSON object, so no scene: the smaller module says what is wrong with it.
  }
  return keys.some((key) => ofAll.test(key)) ? (forAll ??= loadWithLists()) : (forOne ??= load());
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
