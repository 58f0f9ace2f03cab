// SPDX-License-Identifier: Apache-2.0
//
// A robot in 3D: links posed by forward kinematics, drawn with WebGL from boxes, cylinders, spheres and meshes.
//
//   const scene = createScene(canvas, run.links, motion);   // null where WebGL is missing
//   scene.draw(q);   // q: joint positions, rad or m
//
// motion: some joint positions of the recording; the view is made wide enough for all of them.
// A link: {parent, joint, factor, offset, kind, axis, pose, shapes}. parent: index or -1; joint: index in q or -1 (fixed);
// pose: of its frame in the parent's at q = 0; a shape: {kind, size, pose, color}, of kind mesh with
// {middle, step, vertices, triangles} (figures/scene.py). Poses are 4 x 4, column by column. The z axis points up, lengths in m.
"use strict";

function perspective(fovy, aspect, near, far) {
  const f = 1 / Math.tan(fovy / 2), d = near - far;
  return new DOMMatrix([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / d, -1, 0, 0, 2 * far * near / d, 0]);
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function normalised(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((value) => value / length);
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Unit vectors of a camera that looks along -back, its y axis towards the sky.
function cameraAxes(back) {
  const right = normalised(cross([0, 0, 1], back));
  return {right, up: cross(back, right), back};
}

function lookAt(eye, target) {
  const {right, up, back} = cameraAxes(normalised(eye.map((value, i) => value - target[i])));
  return new DOMMatrix([...right, 0, ...up, 0, ...back, 0, ...eye, 1]).inverse();
}

// ---- unit shapes: positions and normals of triangles ------------------------------------------

// Triangles of a grid of points, point(u, v) -> [position, normal], u and v in [0, 1].
function grid(columns, rows, point) {
  const vertices = [];
  const push = (i, j) => vertices.push(...point(i / columns, j / rows).flat());
  for (let i = 0; i < columns; ++i) {
    for (let j = 0; j < rows; ++j) {
      push(i, j); push(i + 1, j); push(i + 1, j + 1);
      push(i, j); push(i + 1, j + 1); push(i, j + 1);
    }
  }
  return vertices;
}

function unitBox() {
  const faces = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      faces.push(...grid(1, 1, (u, v) => {
        const position = [0, 0, 0], normal = [0, 0, 0];
        position[axis] = side / 2;
        position[(axis + 1) % 3] = u - 0.5;
        position[(axis + 2) % 3] = v - 0.5;
        normal[axis] = side;
        return [position, normal];
      }));
    }
  }
  return faces;
}

function unitCylinder() {
  const circle = (u) => [Math.cos(2 * Math.PI * u), Math.sin(2 * Math.PI * u)];
  const side = grid(48, 1, (u, v) => [[...circle(u), v - 0.5], [...circle(u), 0]]);
  const cap = (z) => grid(48, 1, (u, v) => [[v * circle(u)[0], v * circle(u)[1], z], [0, 0, 2 * z]]);
  return [...side, ...cap(-0.5), ...cap(0.5)];
}

function unitSphere() {
  return grid(36, 18, (u, v) => {
    const polar = Math.PI * v, [x, y] = [Math.cos(2 * Math.PI * u), Math.sin(2 * Math.PI * u)];
    const normal = [x * Math.sin(polar), y * Math.sin(polar), Math.cos(polar)];
    return [normal, normal];
  });
}

// ---- meshes -----------------------------------------------------------------------------------

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

const kSmooth = 0.8;  // cosine of the largest angle between faces that look like one curved face

// Positions and normals of a mesh's triangles.
function meshTriangles({middle, step, vertices, triangles}) {
  const steps = new Int16Array(bytesOf(vertices)), corners = new Uint16Array(bytesOf(triangles));
  const place = (i) => middle.map((value, k) => value + step * steps[3 * i + k]);
  const normals = [];  // of each triangle, as long as twice its area
  const around = Array.from({length: steps.length / 3}, () => []);
  for (let f = 0; f < corners.length; f += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => place(corners[f + k]));
    normals.push(cross(b.map((value, k) => value - a[k]), c.map((value, k) => value - a[k])));
    for (let k = 0; k < 3; ++k) around[corners[f + k]].push(f / 3);
  }
  const directions = normals.map(normalised);
  const result = [];
  corners.forEach((corner, i) => {
    const own = directions[Math.floor(i / 3)], sum = [0, 0, 0];
    for (const face of around[corner]) {
      if (dot(own, directions[face]) > kSmooth) normals[face].forEach((value, k) => { sum[k] += value; });
    }
    result.push(...place(corner), ...normalised(sum));
  });
  return result;
}

// ---- drawing ----------------------------------------------------------------------------------

const kFieldOfView = 0.62;  // rad, from top to bottom

const kVertexShader = `
  attribute vec3 position, normal;
  uniform mat4 view_projection, pose;
  uniform vec3 scale;
  uniform mediump float shadow;  // 1: flatten onto the floor along the light
  varying vec3 n;
  varying vec3 p;
  void main() {
    vec4 world = pose * vec4(position * scale, 1.0);
    if (shadow > 0.5) {
      vec3 light = normalize(vec3(0.35, -0.45, 1.0));
      world.xyz -= light * (world.z / light.z);
      world.z = 0.001;
    }
    p = world.xyz;
    n = mat3(pose) * normal;
    gl_Position = view_projection * world;
  }`;

const kFragmentShader = `
  precision mediump float;
  varying vec3 n;
  varying vec3 p;
  uniform vec3 color, eye;
  uniform mediump float shadow;
  void main() {
    if (shadow > 0.5) {
      gl_FragColor = vec4(0.16, 0.18, 0.22, 0.20);
      return;
    }
    vec3 normal = normalize(n);
    vec3 to_eye = normalize(eye - p);
    if (dot(normal, to_eye) < 0.0) normal = -normal;
    vec3 light = normalize(vec3(0.35, -0.45, 1.0));
    float diffuse = max(dot(normal, light), 0.0);
    float sky = 0.5 + 0.5 * normal.z;
    float shine = pow(max(dot(normal, normalize(light + to_eye)), 0.0), 40.0);
    gl_FragColor = vec4(color * (0.30 + 0.28 * sky + 0.50 * diffuse) + 0.12 * shine, 1.0);
  }`;

function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(program));
  return program;
}

function upload(gl, vertices) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
  return {buffer, count: vertices.length / 6};
}

// Poses of all links in the frame of the root, by forward kinematics.
function linkPoses(links, q) {
  const poses = [];
  for (const link of links) {
    const pose = (poses[link.parent] || new DOMMatrix()).multiply(new DOMMatrix(link.pose));
    if (link.joint >= 0) {
      const value = link.factor * q[link.joint] + link.offset;
      if (link.kind === "prismatic") pose.translateSelf(...link.axis.map((component) => component * value));
      else pose.rotateAxisAngleSelf(...link.axis, value * 180 / Math.PI);
    }
    poses.push(pose);
  }
  return poses;
}

// Corners of the boxes about a link's shapes, or its origin where it has none, in the link's frame.
function cornersOf(link) {
  const corners = link.shapes.length ? [] : [[0, 0, 0]];
  for (const shape of link.shapes) {
    let middle = [0, 0, 0], half;
    if (shape.kind === "mesh") {
      const steps = new Int16Array(bytesOf(shape.vertices));
      half = [0, 0, 0];
      steps.forEach((value, i) => { half[i % 3] = Math.max(half[i % 3], Math.abs(value) * shape.step); });
      middle = shape.middle;
    } else if (shape.kind === "box") half = shape.size.map((size) => size / 2);
    else if (shape.kind === "cylinder") half = [0.7 * shape.size[0], 0.7 * shape.size[0], shape.size[1] / 2];
    else half = [0.6, 0.6, 0.6].map((share) => share * shape.size[0]);
    for (let k = 0; k < 8; ++k) {
      const corner = half.map((size, axis) => middle[axis] + (k >> axis & 1 ? size : -size));
      corners.push(transformed(new DOMMatrix(shape.pose), corner));
    }
  }
  return corners;
}

function transformed(pose, corner) {
  const {x, y, z} = pose.transformPoint(new DOMPoint(...corner));
  return [x, y, z];
}

// Corners of the robot in some positions, m.
function pointsOf(links, motion) {
  const corners = links.map(cornersOf);
  return motion.flatMap((q) => linkPoses(links, q).flatMap((pose, i) => corners[i].map((corner) => transformed(pose, corner))));
}

// From the target to a camera, of length 1.
function backwards(azimuth, elevation) {
  return [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
}

// Where a camera looking that way sees all the points as large as they fit: its target, and its distance from there.
function fitted(points, azimuth, elevation, aspect) {
  const {right, up, back} = cameraAxes(backwards(azimuth, elevation));
  const slope = 0.94 * Math.tan(kFieldOfView / 2);
  // |x - centre| <= slope (distance - depth) for each point, and so for y: the tightest of these.
  const extent = (axis, tangent) => {
    let least = Infinity, most = -Infinity;
    for (const point of points) {
      const across = dot(point, axis), depth = tangent * dot(point, back);
      least = Math.min(least, across - depth);
      most = Math.max(most, across + depth);
    }
    return {centre: (least + most) / 2, distance: (most - least) / (2 * tangent)};
  };
  const x = extent(right, slope * aspect), y = extent(up, slope);
  return {
    target: right.map((value, k) => x.centre * value + y.centre * up[k]),
    distance: Math.max(x.distance, y.distance)};
}

function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

// Lines of the floor as thin boxes: a square of 2.4 m, every 0.2 m.
function floorLines() {
  const lines = [];
  for (let i = -6; i <= 6; ++i) {
    const width = i === 0 ? 0.012 : 0.007;
    lines.push({pose: new DOMMatrix().translate(0.2 * i, 0), scale: [width, 2.4, 0.0005]});
    lines.push({pose: new DOMMatrix().translate(0, 0.2 * i), scale: [2.4, width, 0.0005]});
  }
  return lines;
}

// The scale that turns the unit shape into one of the given size (as in URDF: box x y z, cylinder radius length, sphere radius).
function shapeScale(shape) {
  const s = shape.size;
  if (shape.kind === "box") return s;
  return shape.kind === "cylinder" ? [s[0], s[0], s[1]] : [s[0], s[0], s[0]];
}

function createScene(canvas, links, motion) {
  const gl = canvas.getContext("webgl", {alpha: false, antialias: true, stencil: true, preserveDrawingBuffer: true});
  if (!gl) return null;
  const program = compile(gl, kVertexShader, kFragmentShader);
  const meshes = {
    box: upload(gl, unitBox()), cylinder: upload(gl, unitCylinder()), sphere: upload(gl, unitSphere())};
  const uniform = (name) => gl.getUniformLocation(program, name);
  const locations = Object.fromEntries(
      ["view_projection", "pose", "scale", "color", "eye", "shadow"].map((name) => [name, uniform(name)]));
  const lines = floorLines();
  links.forEach((link) => link.shapes.filter((shape) => shape.kind === "mesh").forEach((shape) => {
    shape.mesh = upload(gl, meshTriangles(shape));
  }));
  const points = pointsOf(links, motion);
  const home = {azimuth: -0.9, elevation: 0.38, zoom: 1};
  const view = {...home};
  let last_q = null, fit = {aspect: 0};

  function bind(mesh) {
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
    for (const [name, offset] of [["position", 0], ["normal", 12]]) {
      const location = gl.getAttribLocation(program, name);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 24, offset);
    }
  }

  function drawMesh(mesh, pose, scale, color) {
    bind(mesh);
    gl.uniformMatrix4fv(locations.pose, false, pose.toFloat32Array());
    gl.uniform3fv(locations.scale, scale);
    gl.uniform3fv(locations.color, color);
    gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
  }

  function drawRobot(poses) {
    links.forEach((link, i) => {
      for (const shape of link.shapes) {
        const pose = poses[i].multiply(new DOMMatrix(shape.pose));
        drawMesh(shape.mesh || meshes[shape.kind], pose, shapeScale(shape), shape.color);
      }
    });
  }

  function drawShadow(poses) {
    // The stencil lets each pixel of the floor be darkened once, however many shapes lie above it.
    gl.uniform1f(locations.shadow, 1);
    gl.enable(gl.BLEND);
    gl.enable(gl.STENCIL_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.stencilFunc(gl.EQUAL, 0, 0xff);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.depthMask(false);
    drawRobot(poses);
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
    gl.uniform1f(locations.shadow, 0);
  }

  function draw(q) {
    last_q = q;
    const {width, height} = sized(canvas, 1);
    if (width === 0 || height === 0) return;
    const aspect = width / height;
    if (fit.aspect !== aspect) fit = {aspect, ...fitted(points, home.azimuth, home.elevation, aspect)};
    const target = fit.target, distance = view.zoom * fit.distance;
    const eye = backwards(view.azimuth, view.elevation).map((share, i) => target[i] + distance * share);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...rgb(themeColor("scene")), 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.useProgram(program);
    const projection = perspective(kFieldOfView, aspect, 0.02 * distance, 20 * distance);
    gl.uniformMatrix4fv(locations.view_projection, false, projection.multiply(lookAt(eye, target)).toFloat32Array());
    gl.uniform3fv(locations.eye, eye);
    gl.uniform1f(locations.shadow, 0);
    const floor = rgb(themeColor("floor"));
    for (const line of lines) drawMesh(meshes.box, line.pose, line.scale, floor);
    const poses = linkPoses(links, q);
    drawShadow(poses);
    drawRobot(poses);
  }

  function turn(azimuth, elevation, zoom) {
    view.azimuth += azimuth;
    view.elevation = Math.min(1.5, Math.max(-0.2, view.elevation + elevation));
    view.zoom = Math.min(5, Math.max(0.25, view.zoom * zoom));
    if (last_q) draw(last_q);
  }

  function reset() {
    Object.assign(view, home);
    if (last_q) draw(last_q);
  }

  attachOrbit(canvas, turn, reset);
  return {draw, turn, reset};
}

// Mouse, touch and keyboard turn the view; the wheel zooms once the view has the focus, so that a page can still be scrolled.
function attachOrbit(canvas, turn, reset) {
  canvas.tabIndex = 0;
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) turn(-0.008 * event.movementX, 0.008 * event.movementY, 1);
  });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus();
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    turn(0, 0, Math.exp(0.001 * event.deltaY));
  }, {passive: false});
  canvas.addEventListener("dblclick", reset);
  const keys = {
    ArrowLeft: [0.1, 0, 1], ArrowRight: [-0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1],
    "+": [0, 0, 0.9], "-": [0, 0, 1.1]};
  canvas.addEventListener("keydown", (event) => {
    if (event.key in keys) turn(...keys[event.key]);
    else if (event.key === "0") reset();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}

// ---- motions: base64 of little-endian float32 ---------------------------------------------------

function decode(base64) {
  return new Float32Array(bytesOf(base64));
}

// Joint positions at time t, linear between samples.
function positionsAt(time, q, t) {
  const i = indexAt(time, t), next = Math.min(i + 1, time.length - 1);
  const share = next > i ? Math.min(1, Math.max(0, (t - time[i]) / (time[next] - time[i]))) : 0;
  return q.map((row) => row[i] + share * (row[next] - row[i]));
}
