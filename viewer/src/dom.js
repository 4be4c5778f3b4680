// Small helpers to make elements. Text is always set as text, never as HTML.

/** An element with attributes, properties (functions and booleans) and children. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function' || typeof value === 'boolean') made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((c) => c !== null && c !== undefined));
  return made;
}

export function choice(label, entries, value, onChange) {
  const select = element('select', { 'aria-label': label });
  for (const [key, text] of entries) select.append(element('option', { value: key }, text));
  select.value = value;
  select.addEventListener('change', () => onChange(select.value));
  return select;
}

/** A field for a number; the empty text is `undefined`. */
export function numberField(label, value, onChange) {
  const field = element('input', { type: 'number', step: 'any', 'aria-label': label, value });
  field.addEventListener('change', () => onChange(field.value === '' ? undefined : Number(field.value)));
  return field;
}

export function slider(label, { min, max, step, value }, onInput) {
  const made = element('input', { type: 'range', min, max, step, 'aria-label': label });
  made.value = value;
  made.addEventListener('input', () => onInput(Number(made.value)));
  return made;
}

export const button = (text, onclick, more = {}) => element('button', { type: 'button', onclick, ...more }, text);

export function checkbox(label, value, onChange) {
  const box = element('input', { type: 'checkbox' });
  box.checked = value;
  box.addEventListener('change', () => onChange(box.checked));
  return element('label', {}, label, box);
}
