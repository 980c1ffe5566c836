// An element of a page or of a drawing.
function make(tag, attributes = {}, ...children) {
  const drawn = ["svg", "g", "path", "rect", "circle", "line", "text"].includes(tag);
  const element = drawn ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}
