// node engine.mjs PACKAGE: the package under node, in this thread and in a worker. PACKAGE is its folder.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import test from "node:test";
import {Worker} from "node:worker_threads";
import {deflateSync} from "node:zlib";

const folder = process.argv[2];
const dartcast = await import(`${folder}/dartcast.mjs`);
const {load, RemoteSimulation, Simulation} = dartcast;

const vessel = {
  environment: {generator: "vessel", core: 4, rings: 1, tissue_layers: 1, step_length: 1.4e-3},
  deformation: [{kind: "pulse", amplitude: 0.12, period: 0.1, wavelength: 0.12, field: "pulse_direction", path: "path_length"}],
  particles: [{count: 500}, {inlet: "inlet", rate: 1000}],
  catheter: [{entry: [0, -0.006376, -0.026761], direction: [0, 0.472, 0.882], length: 0.03, spacing: 1e-3, stiffness: 1e-9}],
  motion: {dt: 3e-4, gravity: [0, -9.81, 0], field: {array: "velocity", frame: "mesh"}, drag: 5000},
  contact: {response: "reflect", restitution: 0.5, patch: {outlet_left: {response: "escape"}}},
};
const cut = {surface: "disc", point: [0, 0, -0.012], normal: [0, 0, 1], radius: 6e-3, width: 1.2e-3};

test("nothing works before load(), and load() can be repeated", async () => {
  assert.throws(() => new Simulation(vessel), /call `await load\(\)` first/);
  await load();
  await load();
});

test("index.d.ts has the exports and the methods", () => {
  const types = readFileSync(`${folder}/index.d.ts`, "utf8");
  const exported = [...types.matchAll(/^export (?:class|function) (\w+)/gm)].map((m) => m[1]);
  assert.deepEqual(exported.sort(), Object.keys(dartcast).sort());
  const body = /^export class Simulation \{([\s\S]*?)^\}/m.exec(types)[1];
  const methods = [...body.matchAll(/^  (\w+)\(/gm)].map((m) => m[1]);
  assert.deepEqual(methods.sort(), Object.getOwnPropertyNames(Simulation.prototype).sort());
  for (const name of methods.filter((m) => m !== "constructor")) assert.equal(typeof RemoteSimulation.prototype[name], "function", name);
});

test("the vessel flows, a catheter goes in, and all particles are in free cells", () => {
  const simulation = new Simulation(vessel);
  simulation.steer(0, {push: 2e-4, turn: 0.05});
  for (let i = 0; i < 40; ++i) simulation.step();
  const info = simulation.info();
  assert.equal(info.steps, 40);
  assert.equal(info.dimension, 3);
  assert.equal(simulation.positions().length, 3 * info.particles);
  for (const list of [simulation.radii(), simulation.ids()]) assert.equal(list.length, info.particles);
  assert.deepEqual(info.patches.slice(1), ["wall", "inlet", "outlet_left", "outlet_right", "outer"]);
  const [solid] = simulation.solids();
  assert.equal(solid.kind, "catheter");
  assert.ok(solid.points.length > 12 && simulation.catheterFrames(0).length === 3 * solid.points.length);
  assert.ok(simulation.contacts().ids.length * 3 === simulation.contacts().points.length);
  const audit = simulation.audit();
  assert.ok(audit.checked > 500 && audit.failed === 0);
  simulation.delete();
  assert.throws(() => simulation.step(), /deleted/);
});

test("a refusal has the library's words, and changes nothing", () => {
  const simulation = new Simulation(vessel);
  simulation.step(3);
  const before = simulation.stateHash();
  assert.throws(() => simulation.cut({...cut, width: -1}), {message: "[[event]] width = -1: it must be more than 0"});
  assert.throws(() => simulation.steer(4), {message: "simulation: there is no catheter 4 to steer: it has 1, counted from 0"});
  assert.throws(() => simulation.tie({point: [0, 0, 1], normal: [0, 0, 1]}), /no free cell/);
  assert.throws(() => simulation.pull({at: [0, 0, 0], by: [0, 0, 0], reach: 0, duration: 1}), /reach positive/);
  assert.throws(() => new Simulation({...vessel, motion: {dt: 0}}), {message: "[motion] dt = 0: it must be more than 0"});
  assert.throws(() => new Simulation({...vessel, motion: {step: null}}), /motion.step: null cannot be in a scene/);
  assert.throws(() => new Simulation(`[environment]\ngenerator = "box"\n[motion]\ndt = -1`), /^Error: scene.toml:4: /);
  assert.equal(simulation.stateHash(), before);
});

test("a checkpoint goes back over edits, also into another simulation", () => {
  const simulation = new Simulation(vessel);
  simulation.step(5);
  const saved = simulation.checkpoint();
  const {version, triangles} = simulation.walls();
  assert.equal(simulation.walls(version).triangles, undefined);
  const play = (s) => {
    s.cut(cut);
    s.pull({at: [0, 0, 0], by: [1e-3, 0, 0], reach: 5e-3, duration: 3e-3});
    s.step(5);
    return s.stateHash();
  };
  const first = play(simulation);
  assert.ok(simulation.walls(version).version > version);
  assert.notEqual(simulation.walls().triangles.length, triangles.length);
  simulation.restore(saved);
  assert.deepEqual(simulation.walls().triangles, triangles);
  assert.equal(play(simulation), first);
  const other = new Simulation({environment: {generator: "box"}, motion: {dt: 1}});
  other.restore(saved);
  assert.equal(play(other), first);
  assert.throws(() => other.restore({}), /another version/);
});

test("displacements of all vertices are as those around a place", () => {
  const [a, b] = [new Simulation(vessel), new Simulation(vessel)];
  const vertices = a.vertices();
  const displacements = new Float64Array(vertices.length);
  for (let i = 0; i < vertices.length; i += 3) {
    const share = (vertices[i] ** 2 + vertices[i + 1] ** 2 + vertices[i + 2] ** 2) / 1e-4;
    if (share < 1) displacements[i + 1] = 1e-3 * (1 - share) ** 2;
  }
  a.pull({displacements, duration: 3e-3});
  b.pull({at: [0, 0, 0], by: [0, 1e-3, 0], reach: 1e-2, duration: 3e-3});
  a.step(12);
  b.step(12);
  a.vertices().forEach((x, i) => assert.ok(Math.abs(x - b.vertices()[i]) < 1e-9));
});

// Two tetrahedra in all formats.
const points = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1];
const tetrahedra = [0, 1, 2, 3, 1, 2, 3, 4];
const base64 = (bytes) => Buffer.from(bytes).toString("base64");
const zlib_block = (bytes) => {
  const packed = deflateSync(bytes);
  return base64(new Uint8Array(new Uint32Array([1, bytes.length, 0, packed.length]).buffer)) + base64(packed);
};
const raw_block = (bytes) => base64(Buffer.concat([Buffer.from(new Uint32Array([bytes.length]).buffer), bytes]));
const bytes_of = (array) => Buffer.from(array.buffer);
const vtu = (attributes, format, write) => `<?xml version="1.0"?>
<!-- a comment -->
<VTKFile type='UnstructuredGrid' version="0.1" byte_order="LittleEndian" ${attributes}>
<UnstructuredGrid><Piece NumberOfPoints="5" NumberOfCells="2">
<Points><DataArray type="Float64" NumberOfComponents="3" format="${format}">${write(new Float64Array(points))}</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="${format}">${write(new Int32Array(tetrahedra))}</DataArray>
<DataArray type="Int32" Name="offsets" format="${format}">${write(new Int32Array([4, 8]))}</DataArray>
<DataArray type="UInt8" Name="types" format="${format}">${write(new Uint8Array([10, 10]))}</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>`;
const rows = (list, n) => Array.from({length: list.length / n}, (_, i) => list.slice(n * i, n * i + n));
const files = {
  "ascii.vtu": vtu("", "ascii", (a) => a.join(" ")),
  "raw.vtu": vtu(`header_type="UInt32"`, "binary", (a) => raw_block(bytes_of(a))),
  "zlib.vtu": vtu(`header_type="UInt32" compressor="vtkZLibDataCompressor"`, "binary", (a) => zlib_block(bytes_of(a))),
  "medit.mesh": `MeshVersionFormatted 2\nDimension 3\nVertices 5\n${rows(points, 3).map((p) => `${p.join(" ")} 0`).join("\n")}
Tetrahedra 2\n${rows(tetrahedra, 4).map((t) => `${t.map((v) => v + 1).join(" ")} 0`).join("\n")}\nEnd\n`,
  "gmsh.msh": `$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n${rows(points, 3).map((p, i) => `${i + 1} ${p.join(" ")}`).join("\n")}
$EndNodes\n$Elements\n2\n${rows(tetrahedra, 4).map((t, i) => `${i + 1} 4 2 0 1 ${t.map((v) => v + 1).join(" ")}`).join("\n")}\n$EndElements\n`,
};
const of_mesh = (mesh, options) => {
  const simulation = new Simulation({environment: {mesh}, particles: [{count: 20, velocity: [1, 2, 3]}], motion: {dt: 0.1}}, options);
  simulation.step(5);
  return simulation.stateHash();
};

test("a mesh is typed arrays, a file among the files, or bytes", () => {
  const expected = of_mesh({points: new Float64Array(points), tetrahedra: new Uint32Array(tetrahedra)});
  for (const [name, text] of Object.entries(files)) {
    const bytes = new TextEncoder().encode(text);
    assert.equal(of_mesh(`folder/${name}`, {files: {[`folder/${name}`]: bytes}}), expected, name);
    assert.equal(of_mesh({file: name, bytes}), expected, name);
  }
});

test("files that cannot be read are refused in words", () => {
  const read = (text) => () => of_mesh({file: "bad.vtu", bytes: new TextEncoder().encode(text)});
  const {"zlib.vtu": packed, "ascii.vtu": plain} = files;
  assert.throws(read(packed.replaceAll("ZLib", "LZ4")), /'vtkLZ4DataCompressor' is not supported/);
  assert.throws(read(packed.replace(/(eJ[^<]{4})../, "$1xx")), /block 0 cannot be decompressed/);
  assert.throws(read(plain.replace("</Cells>", "")), /line 9: this is no well-formed XML: mismatched tag/);
  assert.throws(read(plain.slice(0, -12)), /no well-formed XML/);
  assert.throws(read(plain.replace("<!--", "<!DOCTYPE a><!--")), /document type/);
  assert.throws(() => of_mesh("nowhere.vtu"), /nowhere.vtu: no such file/);
  assert.throws(() => of_mesh({points: new Float64Array(points), tetrahedra: [0, 1, 2]}), /environment.mesh.tetrahedra: its length/);
});

test("patches, arrays and surfaces come as typed arrays", () => {
  const cube = (low, high) => ({
    points: new Float64Array([...Array(8).keys()].flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2].map((b) => (b ? high : low)))),
    triangles: [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5],
  });
  const mesh = {...cube(0, 4), triangles: [0, 2, 3], hexahedra: [0, 1, 3, 2, 4, 5, 7, 6], cellData: {patch: [7, 0]}};
  mesh.triangles = [];
  mesh.cellData = {free: [1]};
  const simulation = new Simulation({
    environment: {mesh}, solid: [{surface: cube(-0.5, 0.5), at: [2, 2, 2]}],
    particles: [{count: 50, velocity: [1, 2, 3]}], motion: {dt: 0.05}, contact: {response: "reflect"},
  });
  simulation.steerSolid(0, {velocity: [2, 0, 0], turn: [0, 0, 1]});
  simulation.add({body: [{generator: "barrel", radius: 0.2, bulge: 0.05, height: 0.5, staves: 8, spacing: 0.1, at: [1, 1, 1], mass: 1}],
    particles: [{count: 5}]});
  simulation.step(10);
  assert.equal(simulation.positions().length, 3 * 55);
  const [body, solid] = simulation.solids();
  assert.deepEqual([body.kind, solid.kind, solid.triangles.length, solid.points.length], ["body", "solid", 36, 24]);
  assert.ok(body.triangles.length > 36 && solid.points[0] > 1.5);
  assert.equal(simulation.audit().failed, 0);
});

test("a worker gives the same bits, and errors", async () => {
  const here = new Simulation(vessel);
  here.step(10);
  const remote = await RemoteSimulation.make(vessel, {worker: new Worker(`${folder}/worker.mjs`)});
  await remote.step(10);
  assert.equal(await remote.stateHash(), here.stateHash());
  assert.deepEqual(await remote.positions(), here.positions());
  await assert.rejects(remote.steer(7), /no catheter 7/);
  const saved = await remote.checkpoint();
  await remote.step(3);
  await remote.restore(saved);
  assert.equal(await remote.stateHash(), here.stateHash());
  await remote.delete();
  await assert.rejects(remote.step(), /deleted/);
  await assert.rejects(RemoteSimulation.make({}, {worker: new Worker(`${folder}/worker.mjs`)}), /environment/);
});
