// Six symmetric equations by an LDL' factorisation.
#ifndef POSE_LINEAR_H
#define POSE_LINEAR_H

#define PARAMETERS 6

// Factor a positive definite matrix in place, its lower triangle given: L below the diagonal, the reciprocals of D on
// it. Returns 0 if a pivot is not positive, else 1.
int factor_symmetric(float matrix[PARAMETERS][PARAMETERS]);

// Solve A x = b in place.
void solve_factored(float factors[PARAMETERS][PARAMETERS], float right[PARAMETERS]);

#endif
