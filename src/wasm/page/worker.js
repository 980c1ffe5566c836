// What comes behind simulator.js in the page's worker: the packed module once, then scenes.
let simulator;

onmessage = async ({ data }) => {
  if (data.module) {
    simulator = unpacked(data.module).then(load);
    return;
  }
  try {
    postMessage({ answer: (await simulator).simulate(JSON.stringify(data.scene), data.options) });
  } catch (error) {
    postMessage({ error: error.message });
  }
};
