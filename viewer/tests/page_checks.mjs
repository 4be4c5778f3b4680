// Checks that every report must pass, whatever its scene. Each returns nothing, or throws what is wrong.
import assert from 'node:assert/strict';
import { pathToFileURL } from 'node:url';

/** Opens a page and collects what it says and asks for. */
export async function open(browser, file, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 800 }, reducedMotion: 'reduce', ...options });
  const said = [];
  const requests = [];
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && said.push(`${m.type()}: ${m.text()}`));
  page.on('pageerror', (e) => said.push(`error: ${e}`));
  page.on('request', (r) => requests.push(r.url()));
  const url = pathToFileURL(file).href;
  await page.goto(url);
  await page.waitForFunction(() => window.dartcastReport?.whole || window.dartcastReport?.failed, null, { timeout: 120000 });
  return { page, said, requests, url };
}

/** The share of pixels that are not the background, read in the task that draws them. */
export const ink = (page) => page.evaluate(() => {
  const { stage } = window.dartcastReport.viewer;
  stage.drawNow();
  const copy = document.createElement('canvas');
  copy.width = stage.canvas.width;
  copy.height = stage.canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(stage.canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let n = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (Math.abs(data[i] - data[0]) + Math.abs(data[i + 1] - data[1]) + Math.abs(data[i + 2] - data[2]) > 24) ++n;
  }
  return n / (data.length / 4);
});

export const frameCount = (page) => page.evaluate(() => window.dartcastReport.viewer.data.frames.length);
export const goTo = (page, f) => page.evaluate((k) => window.dartcastReport.viewer.player.go(k), f);
/** All coordinates that are drawn: of particles, walls and solids. */
const drawn = (page) => page.evaluate(() => {
  const { particles, walls, solids } = window.dartcastReport.viewer;
  return [...(particles?.visiblePoints() ?? []), ...walls.visiblePoints(), ...solids.points()].map((x) => x.toPrecision(6)).join();
});

async function drawsAndMoves({ page }) {
  await goTo(page, 0);
  assert(await ink(page) > 0.002, 'the first frame draws next to nothing');
  const before = await drawn(page);
  const last = (await frameCount(page)) - 1;
  assert(last > 0, 'there is one frame alone');
  await page.locator('#view input[aria-label="Time"]').fill(String(last));
  assert.equal(await page.evaluate(() => window.dartcastReport.viewer.player.frame), last);
  assert.notEqual(await drawn(page), before, 'the slider moves nothing');
  assert(await ink(page) > 0.002, 'the last frame draws next to nothing');
}

/** Clicks on particles in the middle of nothing else: the one that is named must be where the click was. */
async function clickNamesParticle({ page }) {
  if (!(await page.evaluate(() => window.dartcastReport.viewer.particles?.now().slots.length > 0))) return;
  const target = await page.evaluate(() => {
    const { particles, stage } = window.dartcastReport.viewer;
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    const place = stage.camera.position.clone();
    const { slots, points } = particles.now();
    const all = slots.map((slot, n) => {
      const p = place.clone().fromArray(points, 3 * n).project(stage.camera);
      return { slot, x: ((p.x + 1) * width) / 2, y: ((1 - p.y) * height) / 2, z: p.z };
    });
    // The one whose next neighbour on the screen is farthest, so that the truth is plain.
    let best = null;
    for (const a of all.slice(0, 300)) {
      if (a.x < 5 || a.y < 5 || a.x > width - 5 || a.y > height - 5) continue;
      let next = Infinity;
      for (const b of all) if (b.slot !== a.slot) next = Math.min(next, Math.hypot(a.x - b.x, a.y - b.y));
      if (best === null || next > best.next) best = { ...a, next };
    }
    return best;
  });
  if (target === null || target.next < 1.5) return;
  const box = await page.locator('#view canvas').boundingBox();
  await page.mouse.click(box.x + target.x, box.y + target.y);
  await page.waitForFunction(() => !document.querySelector('#view .picked').hidden, null, { timeout: 5000 });
  const [slot, id, shown] = await page.evaluate(() => {
    const { selection, particles } = window.dartcastReport.viewer;
    return [selection.slot, particles.id[selection.slot], document.querySelector('#view .picked header').textContent];
  });
  assert.equal(slot, target.slot, 'a click names another particle');
  assert(shown.includes(String(id)), 'the panel does not name the particle');
  await page.locator('#view canvas').press('Escape');
  assert(await page.evaluate(() => document.querySelector('#view .picked').hidden), 'Escape does not close the panel');
}

// The plane is the one that the viewer looks at; it stays in the scene when that turns, until it is asked for again.
async function checkCutAcrossTheView(page) {
  const cut = page.getByRole('combobox', { name: 'Cut', exact: true });
  const again = page.getByRole('button', { name: 'Cut across the present view' });
  if (await page.evaluate(() => window.dartcastReport.viewer.stage.dimension) === 2) {
    assert.equal(await again.count(), 0, 'the plane has one view');
    return;
  }
  const angle = () => page.evaluate(() => {
    const { stage } = window.dartcastReport.viewer;
    return -stage.renderer.clippingPlanes[0].normal.dot(stage.towardsViewer);
  });
  await cut.selectOption('view');
  assert(await angle() > 0.999, 'the cut is not across the view');
  await page.evaluate(() => {
    const { stage } = window.dartcastReport.viewer;
    stage.camera.position.applyAxisAngle(stage.camera.up, 1);
    stage.controls.update();
  });
  assert(await angle() < 0.9, 'the cut turns with the viewer');
  await again.click();
  assert(await angle() > 0.999, 'the cut does not follow when it is asked to');
  await cut.selectOption('');
  await page.getByRole('button', { name: 'Show all' }).click();
}

async function optionsChangeThePicture({ page }) {
  const picture = () => page.evaluate(() => {
    const { stage } = window.dartcastReport.viewer;
    stage.drawNow();
    return stage.canvas.toDataURL();
  });
  if (await page.evaluate(() => window.dartcastReport.viewer.particles?.now().slots.length > 1)) {
    const before = await picture();
    await page.getByLabel('Colour by', { exact: true }).selectOption('id');
    assert.notEqual(await picture(), before, 'another quantity changes no colour');
  }
  await page.getByRole('button', { name: 'Show all' }).click();
  const before = await ink(page);
  await page.getByRole('combobox', { name: 'Cut', exact: true }).selectOption('x');
  assert(await ink(page) < before, 'the cutting plane removes nothing');
  await page.getByRole('combobox', { name: 'Cut', exact: true }).selectOption('');
  await checkCutAcrossTheView(page);
  const walls = page.locator('#view .patch select');
  // Particles close to the walls cover more than these.
  const showParticles = (on) => page.evaluate((visible) => { if (window.dartcastReport.viewer.particles) window.dartcastReport.viewer.particles.object.visible = visible; }, on);
  await showParticles(false);
  for (let i = 0; i < await walls.count(); ++i) await walls.nth(i).selectOption('shown');
  const shown = await ink(page);
  for (let i = 0; i < await walls.count(); ++i) await walls.nth(i).selectOption('hidden');
  assert(await walls.count() === 0 || await ink(page) < shown, 'hidden walls are drawn');
  for (let i = 0; i < await walls.count(); ++i) await walls.nth(i).selectOption('transparent');
  await showParticles(true);
}

/** A patch has one colour among the particles that met it and among the walls, and no other patch has it. */
async function patchesHaveOneColour({ page }) {
  const quantity = page.getByLabel('Colour by', { exact: true });
  if (await quantity.count() === 0) return;
  await quantity.selectOption('patch');
  const [met, walls] = await page.evaluate(() => ['.legend .entry', '.patch'].map((kind) =>
    [...document.querySelectorAll(`#view ${kind}`)].map((e) => [e.textContent, e.querySelector('i').style.background])));
  const names = new Map(met);
  for (const row of walls) row[0] = [...names.keys()].find((n) => row[0].startsWith(n)) ?? row[0];
  for (const [name, colour] of walls) if (names.has(name)) assert.equal(names.get(name), colour, `two colours of ${name}`);
  assert.equal(new Set(names.values()).size, names.size, 'two patches have one colour');
}

async function keysWork({ page }) {
  await page.locator('#view canvas').focus();
  await goTo(page, 0);
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.evaluate(() => window.dartcastReport.viewer.player.frame), 1);
  await page.keyboard.press('End');
  assert.equal(await page.evaluate(() => window.dartcastReport.viewer.player.frame), (await frameCount(page)) - 1);
  await page.keyboard.press(' ');
  assert(await page.evaluate(() => window.dartcastReport.viewer.player.playing), 'space does not play');
  await page.keyboard.press(' ');
}

async function fitsNarrowScreens({ page }) {
  await page.setViewportSize({ width: 390, height: 780 });
  await page.waitForTimeout(200);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert(wide <= 390, `the page is ${wide} pixels wide on a screen of 390`);
  assert(await ink(page) > 0.002, 'a narrow screen shows next to nothing');
}

/** Runs all checks on a page of a run, in each of the colour schemes. */
export async function checkReport(browser, file, schemes) {
  for (const colorScheme of schemes) {
    const opened = await open(browser, file, { colorScheme });
    const { page, said, requests, url } = opened;
    assert.equal(await page.evaluate(() => window.dartcastReport.failed ?? ''), '', 'the viewer gave up');
    await clickNamesParticle(opened);
    await drawsAndMoves(opened);
    await keysWork(opened);
    await optionsChangeThePicture(opened);
    await patchesHaveOneColour(opened);
    await fitsNarrowScreens(opened);
    assert.deepEqual(said, [], 'the console has messages');
    assert.deepEqual(requests.filter((r) => r !== url && !r.startsWith('blob:') && !r.startsWith('data:')), [], 'the page asks for more than its file');
    assert((await page.locator('.chart svg').count()) > 0, 'there are no charts');
    await page.close();
  }
}

/** Without WebGL the picture stays and says why, and nothing else breaks. */
export async function checkFallback(browser, file) {
  const { page, said } = await open(browser, file);
  assert(await page.evaluate(() => window.dartcastReport.failed), 'the viewer does not notice that WebGL is missing');
  assert(await page.locator('#view svg.picture').isVisible(), 'there is no still picture');
  assert((await page.locator('#view .fallback').textContent()).includes('WebGL'), 'nothing says why');
  assert.deepEqual(said, [], 'the console has messages');
  await page.close();
}
