// Matrices of 16, column by column, as WebGL takes them.
function perspective(focal, aspect, near, far) {
  const m = new Float32Array(16);
  m[0] = focal / aspect; m[5] = focal;
  m[10] = (far + near) / (near - far); m[11] = -1;
  m[14] = 2 * far * near / (near - far);
  return m;
}

function product(a, b) {
  const m = new Float32Array(16);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) m[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return m;
}

// From world to eye: right, up, back are unit vectors.
function viewMatrix(eye, right, up, back) {
  const m = new Float32Array(16);
  [right, up, back].forEach((axis, row) => {
    for (let k = 0; k < 3; ++k) m[4 * k + row] = axis[k];
    m[12 + row] = -(axis[0] * eye[0] + axis[1] * eye[1] + axis[2] * eye[2]);
  });
  m[15] = 1;
  return m;
}
