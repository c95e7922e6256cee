// The structure in three dimensions, played by three.js from the glTF file of each run, whose axes are x, z and -y of ours.

const VIEWS = { free: [-0.95, 0.42], front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2] }; // azimuth, elevation
const FIELD = 22; // degrees, of view: slight perspective

// Viridis, whose order the colour-blind and a grey print keep.
const SCALE = ["#440154", "#472c7a", "#3b518b", "#2c718e", "#21908d", "#27ad81", "#5cc863", "#aadc32", "#fde725"];

function scaleColour(share, colour = new THREE.Color()) {
  const at = Math.min(1, Math.max(0, share)) * (SCALE.length - 1), index = Math.min(SCALE.length - 2, Math.floor(at));
  return colour.set(SCALE[index]).lerp(new THREE.Color(SCALE[index + 1]), at - index);
}

// The middle of the scale, which neither a light nor a dark page swallows.
const cableColour = (share) => scaleColour(0.3 + 0.5 * share);

// One run: its animation, its meshes by material, and its loads (stress, tension) at each frame.
class Played {
  static async read(bytes) {
    const gltf = await new Promise((resolve, fail) => new THREE.GLTFLoader().parse(bytes, "", resolve, fail));
    const loads = {};
    for (const [name, { most, accessor }] of Object.entries(gltf.parser.json.extras)) {
      loads[name] = { most, shares: (await gltf.parser.getDependency("accessor", accessor)).array };
    }
    return new Played(gltf, loads);
  }

  constructor({ scene, animations: [clip] }, loads) {
    Object.assign(this, { root: scene, loads, frames: clip.tracks[0].times, meshes: {}, points: [] });
    this.mixer = new THREE.AnimationMixer(scene);
    this.action = this.mixer.clipAction(clip).play();
    scene.traverse((node) => {
      if (node.isSkinnedMesh) this.meshes[node.material.name] = node;
      node.frustumCulled = false;
      if (node.name.startsWith("point_")) this.points.push([node.name.slice(6), node]);
    });
  }

  at(time) {
    this.action.time = Math.max(0, time - FIRST);
    this.mixer.update(0);
    this.root.updateMatrixWorld(true);
    const last = this.frames.length - 1, frame = Math.min(below(this.frames, this.action.time), Math.max(0, last - 1));
    const span = this.frames[Math.min(frame + 1, last)] - this.frames[frame];
    this.frame = [frame, span > 0 ? Math.min(1, (this.action.time - this.frames[frame]) / span) : 0];
  }

  // Colour the vertices of a mesh by a load of what they are of, from its values (shares of the largest) at the pose.
  colour(mesh, { shares }, colourOf) {
    const of = mesh.geometry.attributes._of, { color } = mesh.geometry.attributes, [frame, share] = this.frame;
    const count = shares.length / this.frames.length, known = new Map();
    for (let v = 0; v < of.count; v++) {
      const item = of.getX(v);
      if (!known.has(item)) {
        const value = (at) => shares[at * count + item] / 65535;
        known.set(item, colourOf(item < 0 ? null : value(frame) + (share && share * (value(frame + 1) - value(frame)))));
      }
      known.get(item).toArray(color.array, color.itemSize * v);
    }
    color.needsUpdate = true;
  }

  // Where every so many vertices are at some moments, in glTF's axes.
  places(moments = 9, most = 400) {
    const found = [];
    for (let n = 0; n < moments; n++) {
      this.at(FIRST + (n / (moments - 1)) * (LAST - FIRST));
      for (const mesh of Object.values(this.meshes)) {
        const { count } = mesh.geometry.attributes.position, every = Math.max(1, Math.floor(count / most));
        for (let v = 0; v < count; v += every) found.push(mesh.getVertexPosition(v, new THREE.Vector3()).applyMatrix4(mesh.matrixWorld));
      }
      if (!Object.keys(this.meshes).length) this.root.traverse((node) => found.push(node.getWorldPosition(new THREE.Vector3())));
    }
    return found;
  }
}

// The edges of the bodies of a skinned mesh, as lines that follow as it does: sides of quadrilaterals (four vertices each), but for
// those between two that are one plane. Lines are triangles without width, drawn as a wire frame.
function outlineOf(mesh) {
  const { position, normal } = mesh.geometry.attributes, sides = new Map();
  const place = (v) => [0, 1, 2].map((k) => position.getComponent(v, k).toFixed(5)).join();
  const facing = (v, w) => [0, 1, 2].reduce((sum, k) => sum + normal.getComponent(v, k) * normal.getComponent(w, k), 0);
  for (let v = 0; v < position.count; v++) {
    const next = v % 4 === 3 ? v - 3 : v + 1, key = [place(v), place(next)].sort().join();
    const other = sides.get(key)?.find(([w]) => facing(v, w) > 0.99);
    if (other) other.hidden = true;
    else sides.set(key, [...(sides.get(key) ?? []), [v, next]]);
  }
  const lines = [...sides.values()].flatMap((found) => (found.some((side) => side.hidden) ? [] : [[...found[0], found[0][0]]]));
  const geometry = mesh.geometry.clone().setIndex(lines.flat());
  const outline = new THREE.SkinnedMesh(geometry, new THREE.MeshBasicMaterial({ wireframe: true, transparent: true }));
  outline.frustumCulled = false;
  outline.bind(mesh.skeleton, mesh.bindMatrix);
  mesh.parent.add(outline);
  return outline;
}

// Put a camera so that it sees all places from an azimuth and elevation (rad); `fill`: the share of the picture that they take.
function fit(camera, places, [azimuth, elevation], aspect, fill) {
  const up = Math.min(Math.PI / 2 - 1e-4, elevation), flat = Math.cos(up), middle = new THREE.Vector3();
  const towards = new THREE.Vector3(flat * Math.cos(azimuth), Math.sin(up), -flat * Math.sin(azimuth));
  const right = new THREE.Vector3(-Math.sin(azimuth), 0, -Math.cos(azimuth)), above = towards.clone().cross(right);
  for (const axis of [right, above, towards]) {
    let low = Infinity, high = -Infinity;
    for (const place of places) { low = Math.min(low, place.dot(axis)); high = Math.max(high, place.dot(axis)); }
    middle.addScaledVector(axis, 0.5 * (low + high));
  }
  const slope = Math.tan((FIELD * Math.PI) / 360) * fill;
  let away = 0;
  for (const place of places) {
    const off = place.clone().sub(middle);
    away = Math.max(away, off.dot(towards) + Math.max(Math.abs(off.dot(right)) / aspect, Math.abs(off.dot(above))) / slope);
  }
  camera.aspect = aspect;
  camera.near = away / 50;
  camera.far = 20 * away;
  camera.position.copy(middle).addScaledVector(towards, away || 1);
  camera.lookAt(middle);
  camera.updateProjectionMatrix();
  return middle;
}
