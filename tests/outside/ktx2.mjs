// What ktx-parse makes of the exported textures: format, extent, metadata, and every texel. Every comparison has a negative
// control: a value that is off must be noticed.

import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import process from 'node:process';
import { isDeepStrictEqual } from 'node:util';

import { read } from 'ktx-parse';

const url = process.env.LTC_URL;
const GROUPS = 3;

const PRECISIONS = {
    // A number of f32 comes back as it was rounded.
    f32: { vkFormat: 109, bytes: 4, number: (view, at) => view.getFloat32(at, true), error: () => 0, round: Math.fround },
    // Half an ulp: 2^-11 of the number, or 2^-25 where it is below the normal ones.
    f16: {
        vkFormat: 97,
        bytes: 2,
        number: half,
        error: (value) => Math.max(Math.abs(value) * 2 ** -11, 2 ** -25),
        round: (value) => value,
    },
};

/** Ends the script with one line unless `holds`. */
function check(holds, fault) {
    if (!holds) {
        console.error(`ktx2.mjs: ${fault}`);
        process.exit(1);
    }
}

/** The IEEE half at a place. */
function half(view, at) {
    const bits = view.getUint16(at, true);
    const [sign, exponent, fraction] = [bits >> 15 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
}

async function get(path) {
    const response = await fetch(url + path);
    check(response.ok, `GET ${path} answered ${response.status}`);
    return response;
}

/** The texture, served and exported; their texels must be the same. */
async function texture(name, precision) {
    const response = await get(`/v1/tables/${name}/versions/latest/data?format=ktx2&precision=${precision}`);
    const served = read(new Uint8Array(await response.arrayBuffer()));
    const file = join(process.env.LTC_SCRATCH, `${name}-${precision}.ktx2`);
    const options = ['export', name, '--format', 'ktx2', '--precision', precision, '-o', file];
    execFileSync(process.env.LTC_BIN, options, { stdio: ['ignore', 'ignore', 'inherit'] });
    const exported = read(new Uint8Array(readFileSync(file)));
    const [a, b] = [served, exported].map((container) => Buffer.from(container.levels[0].levelData));
    check(a.equals(b), `${name} ${precision}: served and exported texels differ`);
    return served;
}

/** The value of a key, as text without its terminator. */
function text(container, key) {
    const value = container.keyValue[key];
    check(value !== undefined, `there is no key ${key}, but ${Object.keys(container.keyValue)}`);
    const string = typeof value === 'string' ? value : new TextDecoder().decode(value);
    return string.replace(/\0+$/, '');
}

/** The twelve channels of each entry in table order, from the table as JSON. */
function channels(table) {
    const [m, magnitude, fresnel] = ['m', 'magnitude', 'fresnel'].map((array) => table[array].flat(Infinity));
    return magnitude.map((n, i) => [...m.slice(9 * i, 9 * i + 9), n, fresnel[i], 0]);
}

/** Where the four numbers of a group of an entry lie in the level, by the extent of the texture. */
function texelOf(container, shape, entry, group) {
    const { pixelWidth: width, pixelHeight: height } = container;
    const [x, y] = [entry % width, Math.floor(entry / width) % height];
    const slices = shape.slice(0, -2).reduce((product, length) => product * length, 1);
    const slice = Math.floor(entry / (width * height)) + slices * group;
    return (slice * height + y) * width + x;
}

/** The first texel that is not what `expected` says, in words. */
function wrongTexel(container, shape, precision, expected) {
    const data = container.levels[0].levelData;
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    for (const [entry, values] of expected.entries()) {
        for (const [channel, value] of values.entries()) {
            const texel = texelOf(container, shape, entry, Math.floor(channel / 4));
            const found = precision.number(view, (4 * texel + (channel % 4)) * precision.bytes);
            const wanted = precision.round(value);
            if (!(Math.abs(found - wanted) <= precision.error(wanted))) {
                return `entry ${entry}, channel ${channel}: ${found}, not ${wanted}`;
            }
        }
    }
    return undefined;
}

function checkHeader(what, container, shape, precision) {
    const slices = shape.slice(0, -2).reduce((product, length) => product * length, 1);
    const flat = shape.length === 2;
    const expected = {
        vkFormat: precision.vkFormat,
        typeSize: precision.bytes,
        pixelWidth: shape.at(-1),
        pixelHeight: shape.at(-2),
        pixelDepth: flat ? 0 : slices * GROUPS,
        layerCount: flat ? GROUPS : 0,
        faceCount: 1,
        levelCount: 1,
        supercompressionScheme: 0,
    };
    for (const [field, value] of Object.entries(expected)) {
        check(container[field] === value, `${what}: ${field} is ${container[field]}, not ${value}`);
    }
    const bytes = shape.reduce((product, length) => product * length, GROUPS * 4 * precision.bytes);
    check(container.levels.length === 1 && container.levels[0].levelData.byteLength === bytes, `${what}: not ${bytes} bytes`);
    const samples = container.dataFormatDescriptor[0].samples;
    check(samples.length === 4, `${what}: the descriptor has ${samples.length} samples`);
    samples.forEach((sample, i) => {
        const bits = 8 * precision.bytes;
        check(sample.bitOffset === i * bits && sample.bitLength === bits - 1, `${what}: sample ${i} lies elsewhere`);
    });
}

/** /lookup at some nodes is what the texels there say. */
async function checkLookups(name, table, expected) {
    const nodes = table.axes.map((axis) => table[`axis_${axis.quantity}`]);
    const entries = Array.from({ length: 40 }, (_, i) => (i * 101 + 7) % expected.length);
    const queries = entries.map((entry) => {
        const at = {};
        let rest = entry;
        for (let k = nodes.length - 1; k >= 0; k -= 1) {
            at[table.axes[k].quantity] = nodes[k][rest % nodes[k].length];
            rest = Math.floor(rest / nodes[k].length);
        }
        const { theta, phi = 0, alpha, lambda = 1 } = at;
        return { theta, phi, alpha_x: alpha, alpha_y: alpha * lambda };
    });
    const response = await fetch(`${url}/v1/tables/${name}/versions/latest/lookup`, {
        method: 'POST',
        headers: { 'content-type': 'application/json' },
        body: JSON.stringify(queries),
    });
    check(response.ok, `POST lookup answered ${response.status}`);
    const answers = await response.json();
    let compared = 0;
    for (const [i, entry] of entries.entries()) {
        // Below the smallest width that lookups know, an entry at width 0 is not what they give.
        if (queries[i].alpha_y < 1e-4) continue;
        const found = [...answers[i].lobes[0].m, answers[i].magnitude, answers[i].fresnel];
        const off = Math.max(...found.map((value, k) => Math.abs(value - expected[entry][k])));
        check(off < 1e-6, `${name}: /lookup is ${off} off entry ${entry} at ${JSON.stringify(queries[i])}`);
        compared += 1;
    }
    check(compared > 30, `${name}: only ${compared} entries were compared`);
}

for (const name of ['ggx-anisotropic', 'ggx-isotropic']) {
    const version = `/v1/tables/${name}/versions/latest`;
    const manifest = await (await get(version)).json();
    const table = await (await get(`${version}/data?format=json`)).json();
    const expected = channels(table);
    const shape = manifest.axes.map((axis) => axis.len);
    await checkLookups(name, table, expected);
    for (const [label, precision] of Object.entries(PRECISIONS)) {
        const what = `${name} ${label}`;
        const container = await texture(name, label);
        checkHeader(what, container, shape, precision);
        const inside = JSON.parse(text(container, 'LtcTable'));
        check(inside.digest === manifest.digest, `${what}: LtcTable names ${inside.digest}`);
        check(isDeepStrictEqual(inside.axes, manifest.axes), `${what}: LtcTable has other axes`);
        const wrong = wrongTexel(container, shape, precision, expected);
        check(wrong === undefined, `${what}: ${wrong}`);

        // The controls: one number that is off by a hundredth, and two entries that have changed places.
        const off = expected.map((values) => [...values]);
        off[expected.length - 5][4] += 0.01;
        check(wrongTexel(container, shape, precision, off) !== undefined, `${what}: a wrong texel is not noticed`);
        [off[100], off[101]] = [expected[101], expected[100]];
        check(wrongTexel(container, shape, precision, off)?.startsWith('entry 100'), `${what}: an exchange is not noticed`);
        console.log(`${what}: ${container.pixelWidth} x ${container.pixelHeight} x ${container.pixelDepth || container.layerCount}, all texels right`);
    }
}
