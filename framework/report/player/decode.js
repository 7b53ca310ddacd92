// Reads the channels of framework/report/channels.h.

// The bytes of a data element of the page, or of a text: base64, then zlib's format.
async function openedBytes(id, given) {
  const text = atob(given === undefined ? document.getElementById(id).textContent : given);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser cannot decompress the page\'s data (it has no DecompressionStream, which browsers have since 2023)');
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch (error) {
    throw new Error('the data in this page are damaged; write it again');
  }
}

class ChannelReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }

  varint() {   // zigzag; up to 53 bits, so bits above 28 by multiplication
    const bytes = this.bytes;
    let byte = bytes[this.at++], value = byte & 127;
    for (let shift = 7; byte >= 128 && shift < 28; shift += 7) {
      byte = bytes[this.at++];
      value |= (byte & 127) << shift;
    }
    for (let scale = 268435456; byte >= 128; scale *= 128) {
      byte = bytes[this.at++];
      value += (byte & 127) * scale;
    }
    return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
  }

  // The next channel, of `count` values; missing values are NaN.
  channel(count, Kind = Float32Array) {
    const head = this.bytes[this.at], quantum = this.view.getFloat64(this.at + 1, true), order = head & 3;
    this.at += 9;
    const missing = head & 4 ? this.bytes.subarray(this.at, this.at + count) : null;
    if (missing) this.at += count;
    const values = new Kind(count);
    let before = 0, earlier = 0;
    for (let i = 0; i < count; ++i) {
      const whole = this.varint() + (order === 0 ? 0 : order === 1 ? before : 2 * before - earlier);
      values[i] = missing && missing[i] ? NaN : whole * quantum;
      earlier = before;
      before = whole;
    }
    return values;
  }
}
