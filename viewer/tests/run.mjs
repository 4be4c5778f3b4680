// Tests of the viewer in headless Chromium.
//   node tests/run.mjs COMMAND SCENES   runs a scene of each kind with the command dartcast, and checks their reports
//   node tests/run.mjs FILE.html...     checks reports that are there
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch, withoutWebGL } from './browser.mjs';
import { checkControls } from './control_checks.mjs';
import { checkExample, checkLive, checkLiveFallback } from './live_checks.mjs';
import { checkFallback, checkReport } from './page_checks.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));

// Steps of each scene, which has some seven frames then.
const scenes = { vessel: 60, surgery: 460, barrel: 60, catheter_left: 120, grains: 60, maze: 60 };

// Inside a closed surface, which an external program meshes.
function makeSurfaceReport(command, folder, work) {
  const scene = join(work, 'surface.toml');
  writeFileSync(scene, `
[environment]
mesh = { surface = ${JSON.stringify(resolve(folder, 'forceps_jaw.obj'))}, size = 0.2 }
[[particles]]
count = 300
velocity = [0.5, 0.3, 0.4]
[motion]
dt = 2e-2
steps = 60
[output]
every = 10
`);
  const out = join(work, 'surface');
  const done = spawnSync(command, ['run', scene, '-o', out, '-q'], { encoding: 'utf8' });
  if (done.status === 0) return [join(out, 'report.html')];
  if (!done.stderr.includes('is not installed')) throw new Error(`surface: ${done.stderr}`);
  console.log('left out: a report of a meshed surface: tetgen and gmsh are missing');
  return [];
}

function makeReports(command, folder, work) {
  return Object.entries(scenes).map(([name, steps]) => {
    const text = readFileSync(join(folder, `${name}.toml`), 'utf8').replace(/^every = .*$/m, `every = ${Math.ceil(steps / 6)}`);
    const scene = join(work, `${name}.toml`);
    writeFileSync(scene, text);
    const out = join(work, name);
    const done = spawnSync(command, ['run', scene, '-o', out, '--steps', String(steps), '-q'], { encoding: 'utf8' });
    if (done.status !== 0) throw new Error(`${name}: ${done.stderr}`);
    return join(out, 'report.html');
  });
}

/** The page of a live scene; nothing where the engine for browsers is not built. */
function makeLivePage(command, folder, work) {
  const page = join(work, 'live.html');
  const done = spawnSync(command, ['live', join(folder, 'live.toml'), '-o', page], { encoding: 'utf8' });
  if (done.status === 0) return page;
  if (!done.stderr.includes('./dev wasm')) throw new Error(`live: ${done.stderr}`);
  console.log('left out: a live page: the engine is not built (./dev wasm)');
  return null;
}

/** Checks the reports that `makeFiles` gives, and a live page. Returns how many failed. */
async function check(makeFiles, makeLive) {
  const { browser, missing } = await launch();
  if (missing) {
    console.log(`left out: the reports in a browser: ${missing} is missing`);
    return 0;
  }
  const files = makeFiles();
  const live = makeLive();
  let failed = 0;
  const report = async (name, test) => {
    try {
      await test();
      console.log(`ok ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAILED ${name}: ${error.message}\n${error.stack}`);
    }
  };
  // The scheme makes the same difference in every scene.
  for (const [i, file] of files.entries()) await report(file, () => checkReport(browser, file, i === 0 ? ['light', 'dark'] : ['light']));
  for (const scheme of ['light', 'dark']) await report(`the controls of ${files[0]}, ${scheme}`, () => checkControls(browser, files[0], scheme));
  if (live) await checkLive(browser, live, report);
  if (live) await report('the page of docs/live.md', () => checkExample(browser, join(root, 'docs/live.md'), join(root, 'build/wasm/package')));
  await browser.close();
  const { browser: blind } = await launch(withoutWebGL);
  await report(`${files[0]} without WebGL`, () => checkFallback(blind, files[0]));
  if (live) await report(`${live} without WebGL`, () => checkLiveFallback(blind, live));
  await blind.close();
  return failed;
}

const [first, second] = process.argv.slice(2);
if (first.endsWith('.html')) {
  process.exitCode = await check(() => process.argv.slice(2), () => null);
} else {
  const work = mkdtempSync(join(tmpdir(), 'dartcast_viewer_'));
  try {
    process.exitCode = await check(() => [...makeReports(first, second, work), ...makeSurfaceReport(first, second, work)], () => makeLivePage(first, second, work));
  } finally {
    rmSync(work, { recursive: true });
  }
}
