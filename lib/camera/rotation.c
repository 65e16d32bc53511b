/* 3-vectors, unit quaternions and rotation matrices with their rates, in double, for the host: camera paths and rigid
 * motions. */
#include "camera/td_rotation.h"

#include <float.h>
#include <math.h>
#include <string.h>

void td_cross3(const double a[3], const double b[3], double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

int td_all_finite(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i])) return 0;
    return 1;
}

void td_rotation_from_quaternion(const double q[4], double rotation[9]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    rotation[0] = 1.0 - 2.0 * (y * y + z * z);
    rotation[1] = 2.0 * (x * y - w * z);
    rotation[2] = 2.0 * (x * z + w * y);
    rotation[3] = 2.0 * (x * y + w * z);
    rotation[4] = 1.0 - 2.0 * (x * x + z * z);
    rotation[5] = 2.0 * (y * z - w * x);
    rotation[6] = 2.0 * (x * z - w * y);
    rotation[7] = 2.0 * (y * z + w * x);
    rotation[8] = 1.0 - 2.0 * (x * x + y * y);
}

void td_rotation_rate(const double q[4], const double q_dot[4], double rotation_dot[9]) {
    double product[4][4]; /* rates of the products q_a q_b: each entry of the matrix is a sum of such products */
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++) product[a][b] = q_dot[a] * q[b] + q[a] * q_dot[b];
    enum { W, X, Y, Z };
    rotation_dot[0] = -2.0 * (product[Y][Y] + product[Z][Z]);
    rotation_dot[1] = 2.0 * (product[X][Y] - product[W][Z]);
    rotation_dot[2] = 2.0 * (product[X][Z] + product[W][Y]);
    rotation_dot[3] = 2.0 * (product[X][Y] + product[W][Z]);
    rotation_dot[4] = -2.0 * (product[X][X] + product[Z][Z]);
    rotation_dot[5] = 2.0 * (product[Y][Z] - product[W][X]);
    rotation_dot[6] = 2.0 * (product[X][Z] - product[W][Y]);
    rotation_dot[7] = 2.0 * (product[Y][Z] + product[W][X]);
    rotation_dot[8] = -2.0 * (product[X][X] + product[Y][Y]);
}

void td_quaternion_from_rotation(const double rotation[9], double q[4]) {
    const double *r = rotation;
    /* The four values of 4 q_a^2. The largest is at least 1: scaling its row of products below is safe. */
    double square[4] = {1.0 + r[0] + r[4] + r[8], 1.0 + r[0] - r[4] - r[8], 1.0 - r[0] + r[4] - r[8], 1.0 - r[0] - r[4] + r[8]};
    int largest = 0;
    for (int a = 1; a < 4; a++)
        if (square[a] > square[largest]) largest = a;
    double row[4][4] = {{square[0], r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                        {r[7] - r[5], square[1], r[1] + r[3], r[2] + r[6]},
                        {r[2] - r[6], r[1] + r[3], square[2], r[5] + r[7]},
                        {r[3] - r[1], r[2] + r[6], r[5] + r[7], square[3]}}; /* 4 q_a q_b */
    memcpy(q, row[largest], sizeof row[largest]);
    if (!td_normalise_quaternion(q)) return;
    if (q[0] < 0.0)
        for (int a = 0; a < 4; a++) q[a] = -q[a];
}

void td_straighten_rotation(double rotation[9]) {
    double q[4];
    td_quaternion_from_rotation(rotation, q);
    td_rotation_from_quaternion(q, rotation);
}

void td_quaternion_product(const double a[4], const double b[4], double q[4]) {
    const double product[4] = {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                               a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                               a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                               a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
    memcpy(q, product, sizeof product);
}

void td_quaternion_rate(const double q[4], const double omega[3], double q_dot[4]) {
    double cross[3];
    td_cross3(omega, q + 1, cross);
    q_dot[0] = -0.5 * td_dot3(omega, q + 1);
    for (int k = 0; k < 3; k++) q_dot[k + 1] = 0.5 * (q[0] * omega[k] + cross[k]);
}

int td_normalise_quaternion(double q[4]) {
    double largest = fmax(fmax(fabs(q[0]), fabs(q[1])), fmax(fabs(q[2]), fabs(q[3])));
    if (!td_all_finite(q, 4) || !(largest > 0.0)) return 0;
    double unit = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    /* already of unit length: a path that is saved and read back keeps its bits */
    if (fabs(unit - 1.0) <= 8.0 * DBL_EPSILON) return 1;
    double scaled[4], sum = 0.0; /* dividing by the largest first avoids over- and underflow of squares */
    for (int k = 0; k < 4; k++) {
        scaled[k] = q[k] / largest;
        sum += scaled[k] * scaled[k];
    }
    for (int k = 0; k < 4; k++) q[k] = scaled[k] / sqrt(sum);
    return 1;
}

/* v / |v|, and its rate if v has the rate v_dot. Returns 0 if v is no longer than `least`, or NaN. */
static int normalise_with_rate(double v[3], double v_dot[3], double least) {
    double length = td_length3(v);
    if (!(length > least)) return 0;
    for (int k = 0; k < 3; k++) {
        v[k] /= length;
        v_dot[k] /= length;
    }
    double along = td_dot3(v, v_dot);
    for (int k = 0; k < 3; k++) v_dot[k] -= along * v[k];
    return 1;
}

int td_look_at(const double position[3], const double velocity[3], const double target[3], const double up[3],
               double rotation[9], double omega[3]) {
    double forward[3], forward_dot[3], right[3], right_dot[3], down[3], down_dot[3], term[3];
    for (int k = 0; k < 3; k++) {
        forward[k] = target[k] - position[k];
        forward_dot[k] = -velocity[k];
    }
    /* Shorter vectors would be rounding errors: a difference of positions has an error of 1e-16 of their size, and a cross
     * product 1e-16 of its factors' size. */
    double least_forward = 1e-12 * fmax(td_length3(target), td_length3(position)), least_right = 1e-9 * td_length3(up);
    if (!normalise_with_rate(forward, forward_dot, least_forward)) return 0;
    td_cross3(forward, up, right);
    td_cross3(forward_dot, up, right_dot);
    if (!normalise_with_rate(right, right_dot, least_right)) return 0;
    td_cross3(forward, right, down);
    td_cross3(forward_dot, right, down_dot);
    td_cross3(forward, right_dot, term);
    for (int k = 0; k < 3; k++) {
        down_dot[k] += term[k];
        rotation[3 * k] = right[k];
        rotation[3 * k + 1] = down[k];
        rotation[3 * k + 2] = forward[k];
    }
    if (!omega) return 1;
    /* For an orthonormal frame e_i with e_i_dot = omega x e_i: omega = 1/2 sum of e_i x e_i_dot. */
    const double *axes[3] = {right, down, forward}, *rates[3] = {right_dot, down_dot, forward_dot};
    memset(omega, 0, 3 * sizeof *omega);
    for (int i = 0; i < 3; i++) {
        td_cross3(axes[i], rates[i], term);
        for (int k = 0; k < 3; k++) omega[k] += 0.5 * term[k];
    }
    return 1;
}
