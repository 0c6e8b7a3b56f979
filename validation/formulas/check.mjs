// Typesets every formula of explanations with two other programs, which refuse what is no LaTeX.
//
//   node check.mjs explanation.json ...
import { readFileSync } from 'node:fs';
import katex from 'katex';
import temml from 'temml';

const typeset = {
  katex: (latex) => katex.renderToString(latex, { displayMode: true, strict: 'error', throwOnError: true }),
  temml: (latex) => temml.renderToString(latex, { displayMode: true, strict: true, throwOnError: true }),
};

let formulas = 0;
let failed = 0;
for (const file of process.argv.slice(2)) {
  const { designs } = JSON.parse(readFileSync(file, 'utf8'));
  const lines = designs.flatMap((design) => design.sections).flatMap((section) => section.lines);
  for (const { latex } of lines.filter((line) => line.latex !== undefined)) {
    formulas += 1;
    for (const [name, render] of Object.entries(typeset)) {
      try {
        render(latex);
      } catch (error) {
        failed += 1;
        console.error(`FAILED ${file}, ${name}: ${error.message}\n  ${latex}`);
      }
    }
  }
}
console.log(`${formulas} formulas of ${process.argv.length - 2} explanations, ${failed} refused`);
process.exit(failed > 0 || formulas === 0 ? 1 : 0);
