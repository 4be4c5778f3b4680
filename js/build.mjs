// node build.mjs ENGINE.js ENGINE.wasm FOLDER: puts the npm package together. Behind "// --- module" is what a classic script
// cannot have; the rest can be embedded in a page.
import {createHash} from "node:crypto";
import {copyFileSync, mkdirSync, readFileSync, writeFileSync} from "node:fs";

const [glue, wasm, folder] = process.argv.slice(2);
const here = new URL(".", import.meta.url);
const source = (name) => readFileSync(new URL(name, here), "utf8");
mkdirSync(folder, {recursive: true});
const build = createHash("sha256").update(readFileSync(wasm)).digest("hex").slice(0, 16);
const version = /project\(dartcast VERSION (\S+)/.exec(source("../CMakeLists.txt"))[1];
const engine = readFileSync(glue, "utf8").replace(/^if \(typeof exports === 'object'[\s\S]*$/m, "");
writeFileSync(`${folder}/dartcast.mjs`, `${engine}
const build = "${build}";
${source("src/api.js")}
// --- module
base = import.meta.url;
export {load, Simulation, RemoteSimulation, serve};
`);
copyFileSync(wasm, `${folder}/dartcast.wasm`);
for (const name of ["worker.mjs", "index.d.ts", "README.md"]) writeFileSync(`${folder}/${name}`, source(`src/${name}`));
writeFileSync(`${folder}/LICENSE`, source("../LICENSE"));
writeFileSync(`${folder}/package.json`, `${JSON.stringify({...JSON.parse(source("src/package.json")), version}, null, 2)}\n`);
