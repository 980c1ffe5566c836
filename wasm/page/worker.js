// What comes behind simulator.js in the page's worker: the packed module once, then scenes.
let simulator;

async function unpacked(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

onmessage = async ({ data }) => {
  if (data.module) {
    simulator = unpacked(data.module).then(load);
    return;
  }
  try {
    postMessage({ run: (await simulator).simulate(JSON.stringify(data.scene), data.options) });
  } catch (error) {
    postMessage({ error: error.message });
  }
};
