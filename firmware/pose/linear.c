#include "linear.h"

int factor_symmetric(float matrix[PARAMETERS][PARAMETERS]) {
    for (int m = 0; m < PARAMETERS; m++) {
        float *row = matrix[m], scaled[PARAMETERS];
        float pivot = row[m];
        for (int n = 0; n < m; n++) {
            float rest = row[n];
            for (int k = 0; k < n; k++) rest -= scaled[k] * matrix[n][k];
            scaled[n] = rest;
            row[n] = rest * matrix[n][n];
            pivot -= rest * row[n];
        }
        if (!(pivot > 0.0f)) return 0;
        row[m] = 1.0f / pivot;
    }
    return 1;
}

void solve_factored(float factors[PARAMETERS][PARAMETERS], float right[PARAMETERS]) {
    for (int m = 0; m < PARAMETERS; m++)
        for (int k = 0; k < m; k++) right[m] -= factors[m][k] * right[k];
    for (int m = PARAMETERS - 1; m >= 0; m--) {
        right[m] *= factors[m][m];
        for (int k = m + 1; k < PARAMETERS; k++) right[m] -= factors[k][m] * right[k];
    }
}
