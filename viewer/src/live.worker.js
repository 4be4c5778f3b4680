// The worker of a live scene: it owns the engine, answers the page, and keeps checkpoints to undo edits. The page's places are
// around the middle of the scene, the engine's are not. It follows the npm package's program in one script: `load` and
// `Simulation` are from there.
/* global load, Simulation */

const mostUndone = 5; // each checkpoint is a copy of the engine's memory
const pullTime = 60; // steps that a pull takes

let given, sim, middle, shownWalls, saved, contacts;

/** Places around the middle, in floats. */
function centred(places) {
  const out = new Float32Array(places.length);
  for (let i = 0; i < out.length; i += 3) {
    for (let k = 0; k < 3; ++k) out[i + k] = places[i + k] - middle[k];
  }
  return out;
}

const dt = () => sim.info().dt;
const absolute = (place) => place.map((x, k) => x + middle[k]);

function speeds() {
  const v = sim.velocities();
  const out = new Float32Array(v.length / 3);
  for (let i = 0; i < out.length; ++i) out[i] = Math.hypot(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  return out;
}

/** The walls' faces, if an edit has changed them since they were sent last. In the plane they are segments. */
function newFaces({ version, triangles, patches }, dimension) {
  if (version === shownWalls) return null;
  shownWalls = version;
  return { corners: dimension === 2 ? triangles.filter((_, i) => i % 3 < 2) : triangles, patch: Uint16Array.from(patches) };
}

/** Those without triangles are points or chains. A catheter's tip looks along the first three numbers of `tip`. */
function solids() {
  let catheters = 0;
  return sim.solids().map((solid) => ({
    ...solid, points: centred(solid.points), triangles: solid.triangles.length > 0 ? solid.triangles : null,
    tip: solid.kind === 'catheter' ? sim.catheterFrames(catheters++).slice(-9) : null,
  }));
}

/** What the page draws. */
function moment(ms = 0) {
  const { time, steps, dimension, patches } = sim.info();
  const walls = sim.walls(shownWalls);
  const positions = centred(sim.positions());
  return {
    time, steps, dimension, patches, ms, count: positions.length / 3, canUndo: saved.length > 0,
    positions, speeds: speeds(), radii: Float32Array.from(sim.radii()), contacts: centred(contacts),
    walls: { points: centred(walls.points), faces: newFaces(walls, dimension) },
    solids: solids(),
  };
}

function make() {
  sim?.delete();
  sim = new Simulation(given.scene, { files: given.files });
  [saved, contacts, shownWalls] = [[], [], null];
}

/** Changes the scene between two steps, so that it can be undone. */
function edit(change) {
  const began = performance.now();
  const before = sim.checkpoint();
  change();
  saved = [...saved.slice(1 - mostUndone), before];
  contacts = [];
  return { ...moment(), editMs: performance.now() - began };
}

/** An event that finds nothing to work on changes nothing, and raises no error. */
function changed(change, refusal) {
  const before = sim.info().edits;
  change();
  if (sim.info().edits === before) throw new Error(refusal);
}

function boxOf(points) {
  const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  points.forEach((x, i) => {
    box[0][i % 3] = Math.min(box[0][i % 3], x);
    box[1][i % 3] = Math.max(box[1][i % 3], x);
  });
  return box;
}

const answers = {
  async start(scene) {
    given = scene;
    postMessage({ progress: 'Starting the engine …' });
    await load(given.wasm);
    delete given.wasm;
    postMessage({ progress: 'Making the scene …' });
    make();
    const box = boxOf(sim.walls().points);
    middle = box[0].map((x, k) => (x + box[1][k]) / 2);
    return { ...moment(), box };
  },
  run({ steps, steer }) {
    const began = performance.now();
    contacts = [];
    if (steer) sim.steer(0, { push: steer.push * dt(), turn: steer.turn * dt() });
    for (let i = 0; i < steps; ++i) {
      sim.step();
      contacts.push(...sim.contacts().points);
    }
    return moment((performance.now() - began) / steps);
  },
  cut: ({ point, normal, radius, width }) => edit(() => changed(() => sim.cut({ surface: 'disc', point: absolute(point), normal, radius, width }), 'There is nothing to cut.')),
  tie: ({ point, normal, reach }) => edit(() => changed(() => sim.tie({ point: absolute(point), normal, draw: 0.6, reach, duration: pullTime * dt() }), 'There is nothing to tie.')),
  pull: ({ point, displacement, reach }) => edit(() => sim.pull({ at: absolute(point), by: displacement, reach, duration: pullTime * dt() })),
  drop: ({ point, size }) => edit(() => sim.add({ body: [{
    name: `barrel${sim.info().steps}`, generator: 'barrel', radius: 0.75 * size, bulge: 0.2 * size, height: 2 * size, staves: 12, spacing: 0.3 * size, at: absolute(point), rotate: [0.6, 0.3, 0],
    mass: 1e-4, damping: 20,
  }] })),
  undo() {
    sim.restore(saved.pop());
    contacts = [];
    return moment();
  },
  again() {
    make();
    return moment();
  },
  hash: () => ({ hash: sim.stateHash(), steps: sim.info().steps }),
  audit: () => ({ ...sim.audit(), steps: sim.info().steps }),
  memory: () => sim.checkpoint().memory.length,
};

onmessage = async ({ data: { id, what, argument } }) => {
  try {
    const value = await answers[what](argument);
    const buffers = value.positions ? [value.positions, value.speeds, value.radii, value.walls.points].map((a) => a.buffer) : [];
    postMessage({ id, value }, buffers);
  } catch (error) {
    postMessage({ id, error: error.message });
  }
};
