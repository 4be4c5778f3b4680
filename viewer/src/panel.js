// The panel beside the stage: colours of particles, walls by patch, the cutting plane.
import { Vector3 } from 'three';
import { css, checkbox, choice, element } from './dom.js';
import { pageColours, patchColour, scaleGradient, shortNumber } from './colours.js';
import { wallModes } from './walls.js';

const quantities = [['speed', 'speed'], ['kind', 'place in the cell'], ['patch', 'patch met last'], ['residence', 'time in the scene'], ['id', 'number']];

function scaleLegend(low, high, unit) {
  const bar = element('div', { class: 'bar' });
  bar.style.background = scaleGradient;
  return element('div', { class: 'legend' }, bar,
    element('div', { class: 'ends' }, element('span', {}, shortNumber(low)), element('span', {}, `${shortNumber(high)} ${unit}`.trim())));
}

function swatch(colour) {
  const made = element('i', {});
  made.style.background = css(colour);
  return made;
}

export class Panel {
  constructor(particles, walls, stage, redraw, frame) {
    Object.assign(this, { particles, walls, stage, redraw });
    this.legend = element('div', {});
    this.patches = element('div', {});
    this.hits = element('div', {});
    const content = element('details', { class: 'drawer', open: true }, element('summary', {}, 'Options'),
      ...this.particlePart(), ...this.wallPart(), ...this.cutPart(),
      element('p', {}, element('button', { type: 'button', onclick: frame }, 'Show all (F)')));
    this.element = element('div', { class: 'side' }, content);
    this.refresh();
  }

  particlePart() {
    if (!this.particles) return [];
    this.quantity = choice('Colour by', quantities, 'speed', (name) => {
      this.particles.colourBy(name);
      this.refresh();
      this.redraw();
    });
    this.particles.colourBy('speed');
    return [element('h2', {}, 'Particles'), element('label', {}, 'colour by', this.quantity), this.legend];
  }

  wallPart() {
    if (this.walls.sets.length === 0) return [];
    const parts = [element('h2', {}, 'Walls'), this.patches];
    if (this.walls.hitsMax > 0)
      parts.push(checkbox('coloured by hits', false, (on) => { this.walls.byHits = on; this.changeWalls(); }), this.hits);
    if (this.stage.dimension === 3)
      parts.push(checkbox('edges', false, (on) => { this.walls.wires = on; this.changeWalls(); }));
    return parts;
  }

  changeWalls() {
    this.walls.restyle();
    this.refresh();
    this.stage.draw();
  }

  cutPart() {
    const share = element('input', { type: 'range', min: 0, max: 1000, value: 500, 'aria-label': 'Place of the cut' });
    const isFlat = this.stage.dimension === 2;
    const axes = isFlat ? ['x', 'y'] : ['x', 'y', 'z'];
    const views = isFlat ? [] : [['view', 'across the view']];
    let direction = null;
    const change = () => this.stage.clip(direction, Number(share.value) / 1000);
    // The plane keeps its direction when the scene turns, so that one can look at the cut.
    const turn = () => {
      const k = axes.indexOf(axis.value);
      direction = axis.value === '' ? null : k < 0 ? this.stage.towardsViewer : new Vector3().setComponent(k, 1);
      share.disabled = direction === null;
      again.hidden = axis.value !== 'view';
      change();
    };
    const axis = choice('Cut', [['', 'none'], ...axes.map((a) => [a, `across ${a}`]), ...views], '', turn);
    const again = element('button', { type: 'button', hidden: true, onclick: turn }, 'Cut across the present view');
    share.disabled = true;
    share.addEventListener('input', change);
    return [element('h2', {}, 'Cutting plane'), element('label', {}, 'cut', axis), share, again];
  }

  /** Legends and patches with the colours of the page as they are now. */
  refresh() {
    const page = pageColours();
    if (this.particles) {
      const q = this.particles.colouredBy;
      this.legend.replaceChildren(q.categories
        ? element('div', { class: 'legend' }, ...q.categories.slice(0, 12).map((name, i) =>
          element('span', { class: 'entry' }, swatch(q.colour(i, page)), name)))
        : scaleLegend(q.low, q.high, q.unit));
    }
    this.patches.replaceChildren(...this.walls.usedPatches().map((patch) => {
      const name = this.walls.patches[patch] || 'no patch';
      const mode = choice(`Wall ${name}`, wallModes.map((m) => [m, m]), this.walls.modes[patch], (value) => {
        this.walls.modes[patch] = value;
        this.changeWalls();
      });
      return element('div', { class: 'patch' }, swatch(patchColour(patch, page)), element('span', { title: name }, name), mode);
    }));
    this.hits.replaceChildren(...(this.walls.byHits ? [scaleLegend(0, this.walls.hitsMax, 'hits, log scale')] : []));
  }
}
