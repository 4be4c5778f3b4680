// Checks of a live page: it starts, steps, takes every input, undoes, proves its bits, and keeps its memory.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { ink, open } from './page_checks.mjs';

const inPage = (page, code, argument) => page.evaluate(([text, given]) => new Function('live', 'given', `return (${text})(live, given)`)(window.dartcastReport.live, given), [code.toString(), argument]);
const stepsNow = (page) => inPage(page, (live) => live.state.steps);
const said = (page) => page.locator('#view .loading').textContent();
const stepsOn = (page, count) => page.waitForFunction((n) => window.dartcastReport.live.state.steps >= n, count, { timeout: 120000 });
const tool = (page, name) => page.getByRole('button', { name, exact: true }).click();

/** A place on the screen, on the trunk: on the way from the middle of the inlet to the middle of the scene. */
async function onTrunk(page, share) {
  const [x, y] = await inPage(page, (live, s) => {
    const set = live.walls.sets[0];
    const inlet = live.walls.patches.indexOf('inlet');
    const p = live.stage.camera.position.clone().set(0, 0, 0);
    const q = p.clone();
    let count = 0;
    set.patch.forEach((patch, t) => {
      if (patch !== inlet) return;
      ++count;
      p.add(q.fromArray(set.points, 3 * set.corners[3 * t]));
    });
    p.multiplyScalar((1 - s) / count).project(live.stage.camera);
    const { clientWidth: width, clientHeight: height } = live.stage.canvas;
    return [((p.x + 1) * width) / 2, ((1 - p.y) * height) / 2];
  }, share);
  const box = await page.locator('#view canvas').boundingBox();
  return [box.x + x, box.y + y];
}

/** Waits for what an edit says, and gives it. */
async function afterEdit(page, make) {
  await make();
  await page.waitForFunction(() => window.dartcastReport.live.edits === 0 && document.querySelector('#view .loading').textContent !== '…', null, { timeout: 60000 });
  return said(page);
}

async function steers(page) {
  const tip = () => inPage(page, (live) => Array.from(live.solids.catheters[0].series.values).slice(-3));
  const links = () => inPage(page, (live) => live.solids.catheters[0].series.values.length / 3);
  const before = await links();
  await page.locator('#view canvas').focus();
  await page.keyboard.down('ArrowUp');
  assert.equal(await inPage(page, (live) => live.input.push), 1, 'the key pushes nothing');
  await page.waitForFunction((n) => window.dartcastReport.live.solids.catheters[0].series.values.length / 3 > n, before, { timeout: 60000 });
  await page.keyboard.up('ArrowUp');
  const first = await tip();
  const push = await page.getByLabel('Push', { exact: true }).boundingBox();
  await page.mouse.move(push.x + 10, push.y + 10);
  await page.mouse.down();
  assert.equal(await inPage(page, (live) => live.input.push), 1, 'the button pushes nothing');
  await page.waitForFunction((n) => window.dartcastReport.live.solids.catheters[0].series.values.length / 3 > n + 2, before, { timeout: 60000 });
  await page.mouse.up();
  assert.notDeepEqual(await tip(), first, 'the button does not push');
  assert(await page.locator('#view .tip').isVisible(), 'the tip camera shows nothing');
  assert.deepEqual(await inPage(page, (live) => live.input), { push: 0, turn: 0 }, 'an input stays');
}

async function cutsTiesPulls(page, isPhone) {
  const faces = () => inPage(page, (live) => live.walls.sets[0].patch.length);
  const hash = () => inPage(page, (live) => live.hash());
  await page.getByRole('button', { name: 'Pause' }).click();
  await page.waitForTimeout(300);
  const [steps, before, whole] = [await stepsNow(page), await hash(), await faces()];
  // Across the trunk.
  await tool(page, 'Cut');
  const [[ax, ay], [bx, by]] = [await onTrunk(page, 0.35), await onTrunk(page, 0.45)];
  const [mx, my, length] = [(ax + bx) / 2, (ay + by) / 2, Math.hypot(bx - ax, by - ay)];
  const [dx, dy] = [(-(by - ay) / length) * 45, ((bx - ax) / length) * 45];
  const cut = await afterEdit(page, async () => {
    await page.mouse.move(mx + dx, my + dy);
    await page.mouse.down();
    await page.mouse.move(mx, my, { steps: 3 });
    assert(await page.locator('#view .stroke.shown').count() === 1, 'no line is drawn');
    await page.mouse.move(mx - dx, my - dy, { steps: 3 });
    await page.mouse.up();
  });
  assert(cut.startsWith('Cut'), cut);
  assert((await faces()) > whole, 'the cut leaves the walls as they were');
  await tool(page, 'Tie');
  const tied = await afterEdit(page, async () => (isPhone ? page.touchscreen.tap : page.mouse.click).call(isPhone ? page.touchscreen : page.mouse, ...await onTrunk(page, 0.1)));
  assert(tied.startsWith('Tied'), tied);
  await tool(page, 'Pull');
  const pulled = await afterEdit(page, async () => {
    await page.mouse.move(...await onTrunk(page, 0.7));
    await page.mouse.down();
    await page.mouse.move(mx, my + 30, { steps: 4 });
    await page.mouse.up();
  });
  assert(pulled.startsWith('Pulled'), pulled);
  await page.getByRole('button', { name: 'Step', exact: true }).click();
  await stepsOn(page, steps + 1);
  for (let i = 0; i < 3; ++i) await afterEdit(page, () => page.getByRole('button', { name: 'Undo' }).click());
  assert.equal(await page.getByRole('button', { name: 'Undo' }).isDisabled(), true, 'more can be undone than was done');
  assert.deepEqual([await stepsNow(page), await hash(), await faces()], [steps, before, whole], 'undone edits leave something behind');
  await tool(page, 'Look');
  await page.getByRole('button', { name: 'Go on' }).click();
}

async function provesItsBits(page, isPhone) {
  if (isPhone) await page.getByRole('button', { name: 'Options' }).click();
  const proof = () => page.locator('#view .proof').textContent();
  const answers = async (name, pattern) => {
    await page.getByRole('button', { name, exact: true }).click();
    await page.waitForFunction((p) => new RegExp(p).test(document.querySelector('#view .proof').textContent), pattern, { timeout: 120000 });
    return proof();
  };
  await answers('State hash', '[0-9a-f]{16}');
  assert((await answers('Audit', 'Audit after')).includes('no failure'), await proof());
  assert((await answers('Compare with native', 'steps from the start, here')).startsWith('The same bits as natively'), await proof());
  if (isPhone) await page.getByRole('button', { name: 'Options' }).click();
}

/** What the page and the engine hold, at two times. The engine remembers the particles that have left. */
async function keepsItsMemory(page) {
  const session = await page.context().newCDPSession(page);
  const heaps = async () => {
    await session.send('HeapProfiler.collectGarbage');
    return [(await session.send('Runtime.getHeapUsage')).usedSize, await inPage(page, (live) => live.engine.ask('memory'))];
  };
  await page.getByLabel('Steps in a picture').selectOption('8');
  const begun = await stepsNow(page);
  await stepsOn(page, begun + 60);
  const before = await heaps();
  await stepsOn(page, begun + 300);
  const grown = (await heaps()).map((bytes, i) => bytes - before[i]);
  assert(grown.every((bytes) => bytes < 2e6), `page and engine grow by ${grown} bytes`);
}

const sizes = [['a desktop', { width: 1200, height: 850 }, 'light'], ['a phone', { width: 390, height: 780 }, 'dark']];

/** Checks a page of a vessel with a catheter. `report` runs a test under a name. */
export async function checkLive(browser, file, report) {
  for (const [name, viewport, colorScheme] of sizes) {
    await report(`${file} on ${name}`, async () => {
      const isPhone = viewport.width < 500;
      const { page, said: messages, requests, url } = await open(browser, file, { viewport, colorScheme, hasTouch: isPhone });
      assert.equal(await page.evaluate(() => window.dartcastReport.failed ?? ''), '', 'the page gave up');
      await stepsOn(page, 3);
      assert(await ink(page) > 0.002, 'next to nothing is drawn');
      assert((await page.evaluate(() => document.documentElement.scrollWidth)) <= viewport.width, 'the page is wider than the screen');
      await steers(page);
      await cutsTiesPulls(page, isPhone);
      await provesItsBits(page, isPhone);
      if (!isPhone) await keepsItsMemory(page);
      assert.deepEqual(messages, [], 'the console has messages');
      assert.deepEqual(requests.filter((r) => r !== url && !r.startsWith('blob:') && !r.startsWith('data:')), [], 'the page asks for more than its file');
      await page.close();
    });
  }
}

/** Without WebGL the page says so. */
export async function checkLiveFallback(browser, file) {
  const { page, said: messages } = await open(browser, file);
  assert((await page.locator('#view .fallback').textContent()).includes('WebGL is missing'), 'nothing says why there is no scene');
  assert.deepEqual(messages, [], 'the console has messages');
  await page.close();
}

/** The page in docs/live.md, with the package beside it: it draws, and takes a click. */
export async function checkExample(browser, docs, npm) {
  const [, example] = /```html\n([^]*?)```/.exec(readFileSync(docs, 'utf8'));
  const kinds = { mjs: 'text/javascript', wasm: 'application/wasm' };
  const server = createServer(({ url }, answer) => {
    if (url === '/') return answer.setHeader('Content-Type', 'text/html').end(example);
    if (!url.startsWith('/node_modules/dartcast/')) return answer.writeHead(204).end();
    const name = url.split('/').at(-1);
    return answer.setHeader('Content-Type', kinds[name.split('.').at(-1)]).end(readFileSync(join(npm, name)));
  });
  await new Promise((next) => server.listen(0, '127.0.0.1', next));
  const page = await browser.newPage();
  const messages = [];
  page.on('console', (m) => messages.push(m.text()));
  page.on('pageerror', (e) => messages.push(String(e)));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const changed = async () => {
    const before = await page.locator('p').textContent();
    await page.waitForFunction((old) => ![old, ''].includes(document.querySelector('p').textContent), before, { timeout: 60000 });
  };
  await changed();
  await page.mouse.click(300, 200);
  await changed();
  assert(await page.evaluate(() => document.querySelector('canvas').getContext('2d').getImageData(0, 0, 640, 480).data.some((x) => x > 0)), 'nothing is drawn');
  assert.deepEqual(messages, [], 'the console has messages');
  await page.close();
  server.close();
}
