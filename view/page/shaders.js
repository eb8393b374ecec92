// Bodies: one vertex buffer a shape, poses by instance. Faces are flat: the normal is that of the drawn triangle.
const bodyVertex = `#version 300 es
layout(location=0) in vec3 part;
layout(location=1) in vec3 place;
layout(location=2) in vec4 turn;
layout(location=3) in vec3 tint;
uniform mat4 toClip;
uniform vec3 low, extent;
out vec3 world;
flat out vec3 colour;
void main() {
  vec3 v = low + part * extent;
  world = place + v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
  colour = tint;
  gl_Position = toClip * vec4(world, 1.0);
}`;
const bodyFragment = `#version 300 es
precision highp float;
in vec3 world;
flat in vec3 colour;
uniform vec3 eye;
uniform float alpha;
out vec4 shown;
void main() {
  vec3 n = normalize(cross(dFdx(world), dFdy(world)));
  vec3 e = normalize(eye - world);
  if (dot(n, e) < 0.0) n = -n;
  float light = 0.45 + 0.4 * max(dot(n, normalize(vec3(0.3, -0.5, 0.8))), 0.0) + 0.2 * dot(n, e);
  shown = vec4(colour * light, alpha);
}`;
// Layers: points and lines in world frame.
const layerVertex = `#version 300 es
layout(location=0) in vec3 place;
layout(location=1) in vec4 tint;
uniform mat4 toClip;
uniform float size, scale, least; // metres; pixels a metre at distance 1; pixels
out vec4 colour;
void main() {
  colour = tint;
  gl_Position = toClip * vec4(place, 1.0);
  gl_PointSize = clamp(size * scale / gl_Position.w, least, 3.0 * least);
}`;
const layerFragment = `#version 300 es
precision mediump float;
in vec4 colour;
uniform bool round;
out vec4 shown;
void main() {
  if (round && length(gl_PointCoord - 0.5) > 0.5) discard;
  shown = colour;
}`;

function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error('This browser does not take a shader: ' + gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error('This browser does not link a shader: ' + gl.getProgramInfoLog(program));
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
    const name = gl.getActiveUniform(program, i).name;
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return {program, uniforms};
}
