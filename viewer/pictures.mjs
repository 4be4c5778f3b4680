// Makes the pictures of README and docs from reports of runs, in headless Chromium.
//   node pictures.mjs COMMAND SCENES OUT [NAME...]
//
// Phases for each picture: run its scenes; open their reports; set colours, walls and camera; draw a frame, cut to what is
// drawn; put pieces, legend and caption together on a page, and write that as a picture. A moving picture is a row of
// these, which img2webp joins.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { livePicture } from './live_pictures.mjs';
import { launch } from './tests/browser.mjs';
import { open } from './tests/page_checks.mjs';

const margin = 14; // pixels around what is drawn
const mostBytes = 2_000_000; // of a moving picture

// `at`: the moment, as a share of the run, or several. `part`: left, top, right and bottom of what is shown, as shares of what
// is drawn. `walls`: how patches are drawn; others as the viewer does. `from`: the direction
// that the camera looks from; `up`: the one that is up. `wallNames`: whether the legend has them. `scheme`: light, if not given. `moving`: the number of frames, and their width.
const pictures = [
  {
    name: 'vessel', scenes: ['vessel'], colour: 'speed', from: [-0.3, -1, -0.1], up: [-1, 0, 0], width: 900, scheme: 'dark', tails: true,
    walls: { inlet: 'hidden', outlet_left: 'hidden', outlet_right: 'hidden' },
    caption: '10,000 particles in a vessel that bends and pulses, coloured by speed',
    moving: { frames: 48, width: 820 },
  },
  {
    name: 'surgery', scenes: ['surgery'], at: 1, colour: 'speed', width: 900,
    caption: 'A vessel that was cut and tied; particles, coloured by speed, are in the gap',
  },
  { name: 'maze', scenes: ['maze'], at: 0.5, colour: 'speed', width: 800, caption: 'A crowd in a maze that sways, coloured by speed' },
  {
    name: 'grains', scenes: ['grains'], at: 0.6, colour: 'speed', width: 700,
    walls: { xmin: 'hidden', ymin: 'hidden', zmax: 'hidden', xmax: 'hidden' }, caption: 'Grains of two sizes come to rest in a box, coloured by speed',
  },
  { name: 'barrel', scenes: ['barrel'], at: 0.08, width: 800, caption: 'A barrel falls through a channel whose walls bulge' },
  // Scenes of docs/howto. Two need files of their user beside them, and are made by name alone.
  {
    name: 'aneurysm', scenes: ['aneurysm'], at: 0.05, colour: 'speed', width: 800, byName: true,
    caption: 'Particles sink in an aneurysm, whose wall is a surface from a file; coloured by speed',
  },
  { name: 'pipe', scenes: ['pipe'], at: 0.75, colour: 'speed', width: 800, byName: true, caption: 'Particles in a pipe of OpenFOAM that moves, coloured by speed' },
  { name: 'contraction', scenes: ['contraction'], at: 0.5, colour: 'speed', width: 800, byName: true, caption: 'Grains in a vessel that contracts in waves, coloured by speed' },
  {
    name: 'forceps', scenes: ['forceps'], at: [0.25, 0.55, 0.85], width: 1500, part: [0.4, 0.58, 0.6, 1], from: [0, -0.88, 0.47], up: [0, 0.47, 0.88],
    caption: 'A forceps goes in closed, opens until its jaws meet the wall, and closes again',
  },
  { name: 'catheter', scenes: ['catheter_left', 'catheter_right'], at: 1, width: 520, wallNames: true, caption: 'A catheter, steered into the left and into the right branch' },
];

function run(program, args) {
  const done = spawnSync(program, args, { encoding: 'utf8' });
  if (done.error?.code === 'ENOENT') throw new Error(`${program} is missing`);
  if (done.status !== 0) throw new Error(`${program}: ${done.stderr}`);
}

/** The report of a scene, with a frame for each of at most a hundred moments. */
function report(command, scenes, scene, work) {
  const out = join(work, scene);
  if (!existsSync(join(out, 'report.html'))) run(command, ['run', join(scenes, `${scene}.toml`), '-o', out, '-q']);
  return join(out, 'report.html');
}

/** Leaves the stage alone on the page, and sets colours and walls. */
async function prepare(page, { colour, walls, width, from, up, tails }) {
  await page.setViewportSize({ width, height: width });
  await page.evaluate(({ colour, walls, from, up, tails }) => {
    const { viewer } = window.dartcastReport;
    const style = document.createElement('style');
    style.textContent = `header,.side,.time,.picked,.axes,.scale,main>:not(#view){display:none!important}main{max-width:none;padding:0}
      #view{border:0!important;border-radius:0!important}#view.live{display:block!important}#view .stage{height:100vh!important;max-height:none!important}`;
    document.head.append(style);
    if (colour && viewer.particles) viewer.particles.colourBy(colour);
    viewer.walls.patches.forEach((name, i) => {
      if (walls?.[name]) viewer.walls.modes[i] = walls[name];
    });
    viewer.walls.restyle();
    viewer.panel.refresh();
    viewer.stage.direction = from ?? null;
    viewer.stage.up = up ?? null;
    if (viewer.particles) viewer.particles.hasTails = tails === true;
    viewer.stage.resize();
    viewer.show(0);
    viewer.frame();
  }, { colour, walls, from, up, tails });
}

/** Shows a frame and says where on the canvas something is drawn: left, top, right, bottom. */
const inkBox = (page, frame) => page.evaluate((f) => {
  const { viewer } = window.dartcastReport;
  viewer.player.go(f);
  viewer.stage.drawNow();
  const { canvas } = viewer.stage;
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  const box = [copy.width, copy.height, 0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (Math.abs(data[i] - data[0]) + Math.abs(data[i + 1] - data[1]) + Math.abs(data[i + 2] - data[2]) <= 12) continue;
    const [x, y] = [(i / 4) % copy.width, Math.floor(i / 4 / copy.width)];
    [box[0], box[1], box[2], box[3]] = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
  }
  return box;
}, frame);

const union = (boxes) => [0, 1, 2, 3].map((k) => (k < 2 ? Math.min : Math.max)(...boxes.map((b) => b[k])));

const partOf = ([left, top, right, bottom], part = [0, 0, 1, 1]) =>
  part.map((share, i) => (i % 2 === 0 ? left + share * (right - left) : top + share * (bottom - top)));

/** A frame as a PNG, cut to a box. */
async function shot(page, frame, box) {
  await page.evaluate((f) => {
    window.dartcastReport.viewer.player.go(f);
    window.dartcastReport.viewer.stage.drawNow();
  }, frame);
  const x = Math.max(0, box[0] - margin);
  const y = Math.max(0, box[1] - margin);
  const size = page.viewportSize();
  const clip = { x, y, width: Math.min(size.width, box[2] + margin) - x, height: Math.min(size.height, box[3] + margin) - y };
  return page.screenshot({ clip });
}

const legendOf = (page, wallNames) => page.evaluate((wanted) => {
  const { panel } = window.dartcastReport.viewer;
  const names = [...panel.patches.querySelectorAll('.patch')].filter((p) => p.querySelector('select').value !== 'hidden')
    .map((p) => `<span class="entry">${p.querySelector('i').outerHTML}${p.querySelector('span').textContent}</span>`);
  return { colours: panel.legend.innerHTML, walls: wanted ? names.join('') : '' };
}, wallNames);

/** Pieces side by side over the legend and the caption. */
async function composed(browser, pieces, legend, { caption, scheme }) {
  const page = await browser.newPage({ viewport: { width: 1400, height: 1200 } });
  const [text, paper] = scheme === 'dark' ? ['#e6e9ed', '#14171b'] : ['#1b1f24', '#fff'];
  const images = pieces.map((p) => `<img src="data:image/png;base64,${p.toString('base64')}">`).join('');
  await page.setContent(`<style>body{margin:0;font:14px system-ui,sans-serif;color:${text};background:${paper}}
    figure{margin:0;display:inline-block;background:${paper}}.images{display:flex;align-items:center;justify-content:center}
    .below{display:flex;align-items:center;gap:8px 18px;flex-wrap:wrap;padding:8px ${margin}px 10px}
    .legend{min-width:190px}.bar{height:9px;border-radius:3px}.ends{display:flex;justify-content:space-between;font-size:12px}
    .entry{display:inline-flex;align-items:center;gap:5px;margin-right:12px}i{width:10px;height:10px;border-radius:2px;display:inline-block}
    figcaption{flex:1 1 260px}</style>
    <figure><div class="images">${images}</div><div class="below">${legend.colours}<span>${legend.walls}</span><figcaption>${caption}</figcaption></div></figure>`);
  // The text is no wider than the pieces.
  await page.evaluate(async () => {
    await Promise.all([...document.images].map((i) => i.decode()));
    const width = [...document.images].reduce((sum, i) => sum + i.naturalWidth, 0);
    document.querySelector('figure').style.width = `${Math.max(width, 480)}px`;
  });
  const made = await page.locator('figure').screenshot();
  await page.close();
  return made;
}

async function still(browser, files, picture) {
  const pieces = [];
  let legend;
  for (const file of files) {
    const { page } = await open(browser, file, { colorScheme: picture.scheme ?? 'light' });
    await prepare(page, picture);
    const last = await page.evaluate(() => window.dartcastReport.viewer.data.frames.length - 1);
    for (const at of [picture.at].flat()) {
      const frame = Math.round(at * last);
      pieces.push(await shot(page, frame, partOf(await inkBox(page, frame), picture.part)));
    }
    legend = await legendOf(page, picture.wallNames);
    await page.close();
  }
  return composed(browser, pieces, legend, picture);
}

async function moving(browser, file, picture, out, work) {
  const { page } = await open(browser, file, { colorScheme: picture.scheme ?? 'light' });
  await prepare(page, { ...picture, width: picture.moving.width });
  const last = await page.evaluate(() => window.dartcastReport.viewer.data.frames.length - 1);
  const frames = Array.from({ length: picture.moving.frames }, (_, i) => (i * last) / (picture.moving.frames - 1));
  const boxes = [];
  for (const f of frames) boxes.push(await inkBox(page, f));
  const box = union(boxes);
  const legend = await legendOf(page, picture.wallNames);
  const names = [];
  for (const [i, f] of frames.entries()) {
    names.push(join(work, `${picture.name}_${String(i).padStart(3, '0')}.png`));
    writeFileSync(names.at(-1), await composed(browser, [await shot(page, f, box)], legend, picture));
  }
  await page.close();
  run('img2webp', ['-loop', '0', '-lossy', '-q', '55', '-m', '6', '-d', '90', ...names, '-o', out]);
  const { size } = statSync(out);
  if (size > mostBytes) throw new Error(`${out} has ${size} bytes; at most ${mostBytes} are wanted`);
}

async function main([command, scenes, out, ...names]) {
  const { browser, missing } = await launch();
  if (missing) throw new Error(`${missing} is missing`);
  const work = mkdtempSync(join(tmpdir(), 'dartcast_pictures_'));
  try {
    for (const picture of pictures.filter((p) => (names.length === 0 ? !p.byName : names.includes(p.name)))) {
      const files = picture.scenes.map((s) => report(command, scenes, s, work));
      if (!picture.moving) writeFileSync(join(out, `${picture.name}.png`), await still(browser, files, picture));
      else await moving(browser, files[0], picture, join(out, `${picture.name}.webp`), work);
      console.log(`${picture.name}: done`);
    }
    if (names.length === 0 || names.includes('live')) await livePicture(browser, command, scenes, out, work, run);
  } finally {
    await browser.close();
    rmSync(work, { recursive: true });
  }
}

await main(process.argv.slice(2));
