// The moving picture of the live page: a catheter is steered while a vessel is cut, tied and pulled.
import { spawnSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { open } from './tests/page_checks.mjs';

const frames = 38;
const steps = 5; // in a frame
const reach = { push: 0.4, turn: 90 };

// What happens at a frame: a tool, and its way on the stage, in shares of its width and height.
const acts = { 10: ['Cut', [0.33, 0.2], [0.4, 0.75]], 17: ['Tie', [0.74, 0.24], [0.74, 0.24]], 23: ['Pull', [0.66, 0.66], [0.66, 0.86]] };

async function draw(page, [tool, from, to]) {
  const box = await page.locator('#view canvas').boundingBox();
  const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
  await page.getByRole('button', { name: tool, exact: true }).click();
  await page.mouse.move(...at(from));
  await page.mouse.down();
  await page.mouse.move(...at(to), { steps: 4 });
  await page.mouse.up();
  await page.evaluate(() => window.dartcastReport.live.done);
}

/** Writes live.webp. `run` starts a program. */
export async function livePicture(browser, command, scenes, out, work, run) {
  const file = join(work, 'live.html');
  const made = spawnSync(command, ['live', join(scenes, 'live.toml'), '-o', file], { encoding: 'utf8' });
  if (made.status !== 0) return console.log(`left out: the picture of the live page: ${made.stderr.trim()}`);
  const { page } = await open(browser, file, { viewport: { width: 680, height: 470 }, colorScheme: 'dark' });
  await page.addStyleTag({ content: 'header,.side,.time,.pad,.scale,.axes{display:none!important}main{max-width:none;padding:0}#view.live{display:block!important}#view .stage{height:100vh!important}' });
  await page.evaluate(() => {
    const { live } = window.dartcastReport;
    live.toggle();
    live.stage.resize();
    live.frame();
  });
  const names = [];
  for (let i = 0; i < frames; ++i) {
    if (acts[i]) await draw(page, acts[i]);
    await page.evaluate(({ count, steer }) => window.dartcastReport.live.act('run', { steps: count, steer }, ''),
      { count: steps, steer: { push: reach.push, turn: i < 8 ? reach.turn : 0 } });
    names.push(join(work, `live_${String(i).padStart(3, '0')}.png`));
    writeFileSync(names.at(-1), await page.screenshot());
  }
  await page.close();
  run('img2webp', ['-loop', '0', '-lossy', '-q', '36', '-m', '6', '-d', '120', ...names, '-o', join(out, 'live.webp')]);
  return console.log('live: done');
}
