"use strict";
// Figures under the pointer: values, zoom by the wheel, pan by dragging, all of it by a double click.
(() => {
  const between = (scale, part) =>
    scale[2] ? scale[0] * (scale[1] / scale[0]) ** part : scale[0] + part * (scale[1] - scale[0]);
  const part = (scale, value) =>
    scale[2] ? Math.log(value / scale[0]) / Math.log(scale[1] / scale[0])
             : (value - scale[0]) / (scale[1] - scale[0]);
  const said = (value, unit) => {
    const size = Math.abs(value);
    const text = size && (size >= 1e6 || size < 1e-3) ? value.toExponential(3)
                                                      : String(+value.toPrecision(4));
    return text.replace("-", "−") + (unit && unit !== "-" ? " " + unit : "");
  };
  const nearest = (values, wanted) => values.reduce(
    (best, value, place) => Math.abs(value - wanted) < Math.abs(values[best] - wanted) ? place : best, 0);
  const element = (kind, parent, style) => {
    const made = parent.appendChild(document.createElement("div"));
    made.className = kind;
    return Object.assign(made.style, style || {}), made;
  };
  let scrolled = 0;  // a page in motion is not to stop at a figure
  addEventListener("scroll", () => { scrolled = performance.now(); }, { passive: true });

  for (const frame of document.querySelectorAll(".frame[data-planes]")) {
    const figure = frame.parentElement, image = frame.querySelector("img");
    const planes = JSON.parse(frame.dataset.planes);
    let scale = 1, left = 0, top = 0, held = null, marks = [];
    const box = element("read", figure);
    box.hidden = true;

    function place() {
      const room = size => size * (1 - scale);
      left = Math.min(0, Math.max(left, room(image.offsetWidth)));
      top = Math.min(0, Math.max(top, room(image.offsetHeight)));
      image.style.transform = scale > 1 ? `translate(${left}px,${top}px) scale(${scale})` : "";
      frame.classList.toggle("zoomed", scale > 1);
    }
    function clear() {
      marks.forEach(mark => mark.remove());
      marks = [];
      box.hidden = true;
    }
    // Of a point on a curve: how far from the pointer it is, and what is said of it.
    function onCurve(plane, pixels, curve, u, v) {
      const [name, colour, xs, ys, ascends] = curve;
      const x = between(plane.x, u), word = name ? name + " " : "";
      let best = null;
      const offer = (px, py, text) => {
        const a = part(plane.x, px), b = part(plane.y, py);
        const far = Math.hypot((a - u) * pixels[0] * (ascends ? 0 : 1), (b - v) * pixels[1]);
        if (a >= 0 && a <= 1 && b >= 0 && b <= 1 && !(best && best.far <= far))
          best = { far, a, b, colour, text: word + text };
      };
      if (ascends) {
        const next = xs.findIndex(one => one >= x);
        if (next > 0 && ys[next] !== null && ys[next - 1] !== null) {
          const share = (x - xs[next - 1]) / (xs[next] - xs[next - 1]);
          const y = ys[next - 1] + share * (ys[next] - ys[next - 1]);
          offer(x, y, said(y, plane.y[4]));
        }
      } else {
        xs.forEach((px, k) => px !== null && ys[k] !== null &&
          offer(px, ys[k], `${said(px, plane.x[4])}, ${said(ys[k], plane.y[4])}`));
        if (best && best.far > 15) best = null;
      }
      return best;
    }
    function show(event) {
      clear();
      const seen = image.getBoundingClientRect(), inside = frame.getBoundingClientRect();
      const fx = (event.clientX - seen.left) / seen.width;
      const fy = 1 - (event.clientY - seen.top) / seen.height;
      const here = planes.filter(({ box: [a, b, c, d] }) => fx >= a && fx <= c && fy >= b && fy <= d);
      const lines = [], swatches = [];
      for (const plane of here) {
        const [a, b, c, d] = plane.box, u = (fx - a) / (c - a), v = (fy - b) / (d - b);
        const at = (x, y) => ({
          left: seen.left - inside.left + (a + x * (c - a)) * seen.width + "px",
          top: seen.top - inside.top + (1 - b - y * (d - b)) * seen.height + "px" });
        if (plane === here[0]) {
          marks.push(element("hair", frame, { ...at(u, 1), height: (d - b) * seen.height + "px" }));
          marks.push(element("hair", frame, { ...at(0, v), width: (c - a) * seen.width + "px" }));
          lines.push(`${plane.x[3]} ${said(between(plane.x, u), plane.x[4])}`.trim());
        }
        lines.push(`${plane.y[3]} ${said(between(plane.y, v), plane.y[4])}`.trim());
        for (const [name, unit, xs, ys, rows] of plane.fields) {
          const value = rows[nearest(ys, between(plane.y, v))][nearest(xs, between(plane.x, u))];
          if (value !== null) lines.push(`${name} ${said(value, unit)}`);
        }
        const pixels = [(c - a) * seen.width, (d - b) * seen.height];
        plane.curves.map(curve => onCurve(plane, pixels, curve, u, v)).filter(Boolean)
          .sort((one, other) => one.far - other.far || other.text.length - one.text.length)
          .filter((one, k, all) => !k || one.far !== all[k - 1].far || one.colour !== all[k - 1].colour)
          .slice(0, 8)
          .sort((one, other) => other.b - one.b)
          .forEach(found => {
            swatches.push([found.colour, found.text]);
            marks.push(element("dot", frame, { ...at(found.a, found.b), background: found.colour }));
          });
      }
      if (!here.length) return;
      box.replaceChildren();
      for (const text of lines) element("", box).textContent = text;
      for (const [colour, text] of swatches) {
        const row = element("", box);
        element("swatch", row, { background: colour });
        row.append(text);
      }
      box.hidden = false;
      const outer = figure.getBoundingClientRect(), x = event.clientX - outer.left;
      const gap = 14, right = x + gap + box.offsetWidth > outer.width && x > box.offsetWidth + gap;
      box.style.left = Math.max(0, right ? x - gap - box.offsetWidth : x + gap) + "px";
      box.style.top = event.clientY - outer.top + gap + "px";
    }

    frame.addEventListener("pointermove", event => {
      if (held) {
        left += event.clientX - held[0];
        top += event.clientY - held[1];
        held = [event.clientX, event.clientY];
        place();
      }
      show(event);
    });
    frame.addEventListener("pointerdown", event => {
      show(event);
      if (scale === 1 || event.button) return;
      event.preventDefault();
      frame.setPointerCapture(event.pointerId);
      held = [event.clientX, event.clientY];
    });
    for (const kind of ["pointerup", "pointercancel"])
      frame.addEventListener(kind, () => { held = null; });
    frame.addEventListener("pointerleave", clear);
    image.addEventListener("dragstart", event => event.preventDefault());
    frame.addEventListener("dblclick", event => {
      scale = 1;
      place();
      show(event);
    });
    frame.addEventListener("wheel", event => {
      const wanted = Math.min(20, Math.max(1, scale * 1.0015 ** -event.deltaY));
      if (wanted === scale || performance.now() - scrolled < 400) return;
      event.preventDefault();
      const seen = image.getBoundingClientRect();
      left -= (event.clientX - seen.left) * (wanted / scale - 1);
      top -= (event.clientY - seen.top) * (wanted / scale - 1);
      scale = wanted;
      place();
      show(event);
    }, { passive: false });
    addEventListener("resize", () => { scale = 1; place(); clear(); });
  }
})();
