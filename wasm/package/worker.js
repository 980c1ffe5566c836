// Simulates for index.js in a thread of its own, in browsers and in node.
import { load } from "./core.js";

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

const loading = load();
const listen = async ({ data }) => {
  try {
    answer({ run: (await loading).simulate(data.scene, data.options) });
  } catch (error) {
    answer({ error: { kind: error.kind, message: error.message } });
  }
};
if (port === globalThis) port.onmessage = listen;
else port.on("message", (data) => listen({ data }));
