// Writes variants of glTF files with gltf-transform: node compress.mjs OUT FILE... prints one line per file written:
// the variant, the file and the file it was made from. TOOLS is the folder where npm installed @gltf-transform/cli.
import path from 'node:path';
import {createRequire} from 'node:module';
const require = createRequire(path.join(process.env.TOOLS, 'node_modules', 'x'));
const load = async (name) => import(require.resolve(name));
const {NodeIO} = await load('@gltf-transform/core');
const {ALL_EXTENSIONS} = await load('@gltf-transform/extensions');
const {dedup, draco, instance, meshopt, quantize, reorder, sparse, unweld, weld} = await load('@gltf-transform/functions');
const draco3d = (await load('draco3dgltf')).default;
const {MeshoptEncoder, MeshoptDecoder} = await load('meshoptimizer');
await MeshoptEncoder.ready;

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  'draco3d.encoder': await draco3d.createEncoderModule(),
  'draco3d.decoder': await draco3d.createDecoderModule(),
  'meshopt.encoder': MeshoptEncoder,
  'meshopt.decoder': MeshoptDecoder,
});
const variants = {
  quantised8: [quantize({quantizePosition: 8, quantizeNormal: 8})],
  quantised12: [quantize({quantizePosition: 12})],
  quantised16: [quantize({quantizePosition: 16, quantizationVolume: 'scene'})],
  draco: [weld(), draco({method: 'edgebreaker'})],
  dracoSequential: [weld(), draco({method: 'sequential'})],
  meshoptMedium: [meshopt({encoder: MeshoptEncoder, level: 'medium'})],
  meshoptHigh: [meshopt({encoder: MeshoptEncoder, level: 'high'})],
  welded: [weld()],
  unwelded: [unweld()],
  sparse: [dedup(), sparse({ratio: 1})],
  reordered: [weld(), reorder({encoder: MeshoptEncoder})],
  instanced: [dedup(), instance({min: 2})],
};
const [out, ...files] = process.argv.slice(2);
for (const [number, file] of files.entries()) {
  for (const [name, steps] of Object.entries(variants)) {
    const document = await io.read(file);
    await document.transform(...steps);
    const to = path.join(out, `${number}_${path.parse(file).name}_${name}.${number % 2 ? 'glb' : 'gltf'}`);
    document.getRoot().listBuffers().forEach((buffer) => buffer.setURI(`${path.parse(to).name}.bin`));
    await io.write(to, document);
    console.log(`${name}\t${to}\t${file}`);
  }
}
