// A headless Chromium for tests, or the name of the program that is missing.
import { existsSync } from 'node:fs';

const flags = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
  '--disable-sync'];
export const withWebGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
export const withoutWebGL = ['--disable-3d-apis'];

export async function launch(more = withWebGL) {
  const path = process.env.CHROMIUM ?? '/usr/bin/chromium';
  if (!existsSync(path)) return { missing: 'chromium' };
  try {
    const { chromium } = await import('playwright-core');
    return { browser: await chromium.launch({ executablePath: path, headless: true, args: [...flags, ...more] }) };
  } catch (error) {
    if (error.code === 'ERR_MODULE_NOT_FOUND') return { missing: 'playwright-core (npm ci in viewer/)' };
    throw error;
  }
}
