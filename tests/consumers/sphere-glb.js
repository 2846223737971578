// A unit sphere as GLB, for the pages of engines that read glTF.

// A white surface; one that is no metal has no reflection of its own.
const white = (metallic, roughness) => ({
    pbrMetallicRoughness: {
        baseColorFactor: [1, 1, 1, 1],
        metallicFactor: metallic,
        roughnessFactor: roughness,
    },
    extensions: { KHR_materials_specular: { specularFactor: metallic } },
});

// `more` is additional JSON of the file; the sphere is node 0 of scene 0.
function sphereGlb(material, more = {}) {
    const [rows, columns] = [96, 192];
    const positions = [];
    const indices = [];
    for (let j = 0; j <= rows; j++) {
        for (let i = 0; i <= columns; i++) {
            const [theta, phi] = [(Math.PI * j) / rows, (2 * Math.PI * i) / columns];
            positions.push(Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi));
            if (j === rows || i === columns) continue;
            const at = j * (columns + 1) + i;
            const below = at + columns + 1;
            indices.push(at, at + 1, below, below, at + 1, below + 1);
        }
    }
    const count = positions.length / 3;
    const binary = new Uint8Array(positions.length * 4 + indices.length * 4);
    binary.set(new Uint8Array(new Float32Array(positions).buffer));
    binary.set(new Uint8Array(new Uint32Array(indices).buffer), positions.length * 4);
    const json = JSON.stringify({
        asset: { version: '2.0' },
        scene: 0,
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0 }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 0 }, indices: 1, material: 0 }] }],
        materials: [material],
        buffers: [{ byteLength: binary.length }],
        bufferViews: [
            { buffer: 0, byteOffset: 0, byteLength: positions.length * 4, target: 34962 },
            { buffer: 0, byteOffset: positions.length * 4, byteLength: indices.length * 4, target: 34963 },
        ],
        accessors: [
            { bufferView: 0, componentType: 5126, count, type: 'VEC3', min: [-1, -1, -1], max: [1, 1, 1] },
            { bufferView: 1, componentType: 5125, count: indices.length, type: 'SCALAR' },
        ],
        ...more,
    });
    const text = new TextEncoder().encode(json.padEnd(Math.ceil(json.length / 4) * 4));
    const glb = new Uint8Array(20 + text.length + 8 + binary.length);
    const view = new DataView(glb.buffer);
    [0x46546c67, 2, glb.length, text.length, 0x4e4f534a].forEach((word, k) =>
        view.setUint32(4 * k, word, true),
    );
    glb.set(text, 20);
    view.setUint32(20 + text.length, binary.length, true);
    view.setUint32(24 + text.length, 0x004e4942, true);
    glb.set(binary, 28 + text.length);
    return glb;
}
