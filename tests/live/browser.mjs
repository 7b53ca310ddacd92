// Drives a headless Chromium through its debugging pipe (descriptors 3 and 4: JSON, each message
// closed by a zero byte), so that nothing but node and the browser is needed.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export class Browser {
  constructor(program = 'chromium') {
    this.folder = mkdtempSync(join(tmpdir(), 'tumble_live_browser_'));
    this.child = spawn(program, ['--headless', '--no-sandbox', '--remote-debugging-pipe', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', `--user-data-dir=${this.folder}`, 'about:blank'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
    this.waiting = new Map();
    this.listeners = [];
    this.last = 0;
    let text = '';
    this.child.stdio[4].on('data', bytes => {
      text += bytes;
      const parts = text.split('\0');
      text = parts.pop();
      for (const part of parts) this.hear(JSON.parse(part));
    });
  }

  hear(message) {
    const waiting = this.waiting.get(message.id);
    if (!waiting) { for (const listener of this.listeners) listener(message); return; }
    this.waiting.delete(message.id);
    if (message.error) waiting.reject(new Error(message.error.message));
    else waiting.resolve(message.result);
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.last;
    this.child.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + '\0');
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  // @param size {width, height}; dark: the dark scheme; before: a script that runs before those of the page
  async open(address, { width = 1400, height = 900, dark = false, before = '' } = {}) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, targetId, sessionId);
    await page.send('Page.enable');
    await page.send('Runtime.enable');
    await page.send('Log.enable');
    await page.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
    await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
    if (before) await page.send('Page.addScriptToEvaluateOnNewDocument', { source: before });
    await page.send('Page.navigate', { url: address });
    return page;
  }

  async close() {
    try { await this.send('Browser.close'); } catch { /* it has gone */ }
    await new Promise(resolve => { if (this.child.exitCode !== null) resolve(); else this.child.on('exit', resolve); });
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
  }
}

export class Page {
  constructor(browser, targetId, sessionId) {
    this.browser = browser;
    this.targetId = targetId;
    this.sessionId = sessionId;
    this.errors = [];
    browser.listeners.push(message => {
      if (message.sessionId !== sessionId) return;
      if (message.method === 'Runtime.exceptionThrown') this.errors.push(message.params.exceptionDetails.exception?.description || message.params.exceptionDetails.text);
      if (message.method === 'Log.entryAdded' && message.params.entry.level === 'error') this.errors.push(`${message.params.entry.text} ${message.params.entry.url || ''}`);
    });
  }

  send(method, params = {}) { return this.browser.send(method, params, this.sessionId); }

  async value(expression) {
    const answer = await this.send('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description || answer.exceptionDetails.text);
    return answer.result.value;
  }

  // Waits until an expression holds; before the page is there it does not. @throws with the page's words
  async until(expression, what, seconds = 60) {
    const end = Date.now() + 1000 * seconds;
    for (;;) {
      const value = await this.value(`(() => { try { return ${expression}; } catch { return false; } })()`);
      if (value) return value;
      if (Date.now() > end) throw new Error(`${what}: not within ${seconds} s; the page says "${await this.value('document.getElementById("state")?.textContent + " " + (document.body?.dataset.trouble || "")')}"`);
      await new Promise(resolve => setTimeout(resolve, 50));
    }
  }

  async mouse(type, x, y, buttons) {
    await this.send('Input.dispatchMouseEvent', { type, x, y, button: type === 'mouseMoved' && !buttons ? 'none' : 'left', buttons: buttons ? 1 : 0, clickCount: 1 });
  }

  async drag(from, to, steps = 5) {
    await this.mouse('mouseMoved', ...from, false);
    await this.mouse('mousePressed', ...from, true);
    for (let i = 1; i <= steps; ++i) await this.mouse('mouseMoved', from[0] + (to[0] - from[0]) * i / steps, from[1] + (to[1] - from[1]) * i / steps, true);
    await this.mouse('mouseReleased', ...to, false);
  }

  async picture(file) {
    const { data } = await this.send('Page.captureScreenshot', { format: 'png' });
    writeFileSync(file, Buffer.from(data, 'base64'));
  }
}
