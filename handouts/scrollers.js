// What is wider than the column scrolls by itself; by the keyboard only where it is a stop of it.
'use strict';
(() => {
  const all = document.querySelectorAll('pre, table, figure, .sourceCode, math[display=block]');
  const look = () => {
    for (const element of all) {
      if (element.scrollWidth > element.clientWidth + 1) element.setAttribute('tabindex', '0');
      else element.removeAttribute('tabindex');
    }
  };
  new ResizeObserver(look).observe(document.body);
  look();
})();
