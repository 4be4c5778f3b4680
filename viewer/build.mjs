// Builds viewer.min.js. Its first line has the hash of the sources (tools/check_viewer.py has the rule).
// With an argument it writes to that file instead.
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const sources = ['build.mjs', 'package-lock.json', 'package.json', ...readdirSync(join(here, 'src')).sort().map((f) => `src/${f}`)];
const hash = createHash('sha256');
for (const name of sources) {
  hash.update(`${name}\n`);
  hash.update(readFileSync(join(here, name)));
}
const result = await build({
  entryPoints: [join(here, 'src/main.js')],
  bundle: true, minify: true, format: 'esm', target: 'es2022', legalComments: 'eof', charset: 'ascii',
  loader: { '.css': 'text', '.worker.js': 'text' }, write: false,
});
// In a page, "</script" would end the program.
const program = result.outputFiles[0].text.replaceAll('</script', '<\\/script');
writeFileSync(process.argv[2] ?? join(here, 'viewer.min.js'), `/* dartcast viewer, sources SHA-256 ${hash.digest('hex')} */\n${program}`);
