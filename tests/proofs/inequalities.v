(* What    What bounds take as given about real numbers: sphere_closest.bound's lines about D, and that sums over the axes
           are no more than the product of the lengths (disc_plane.bound, disc_point.bound). *)
Require Import Reals Lra Psatz.
Open Scope R_scope.

Lemma square_at_least_0 a : 0 <= a * a.
Proof. apply Rle_0_sqr. Qed.

Section Direction.

Variables dx dy dz fx fy fz : R.
Hypothesis unit : dx * dx + (dy * dy + dz * dz) = 1.
Hypotheses (x : 0 <= dx) (y : 0 <= dy) (z : 0 <= dz).
Hypotheses (bx : -1 <= fx <= 1) (by_ : -1 <= fy <= 1) (bz : -1 <= fz <= 1).

Notation D := (dx + dy + dz).

Lemma D_at_least : 1 <= D.
Proof. nra. Qed.

Lemma D_at_most : D <= 1.7321.
Proof.
assert (Q1 := square_at_least_0 (dx - dy)). assert (Q2 := square_at_least_0 (dy - dz)).
assert (Q3 := square_at_least_0 (dx - dz)).
assert (D * D <= 3) by nra. nra.
Qed.

Lemma share_at_most : 0 <= dx * D <= 1.3661.
Proof.
split; [nra|].
assert (Q4 := square_at_least_0 (dy - dz)).
assert (Q5 := square_at_least_0 (dx - 1.366 * (dy + dz))). nra.
Qed.

Lemma sum_of_one : - D <= fz * dz <= D.
Proof. nra. Qed.

Lemma sum_of_two : - D <= fy * dy + fz * dz <= D.
Proof. nra. Qed.

Lemma sum_of_all : - D <= fx * dx + (fy * dy + fz * dz) <= D.
Proof. nra. Qed.

Lemma closest_at_most : -1.3661 <= fx - dx * (fx * dx + (fy * dy + fz * dz)) <= 1.3661.
Proof.
assert (S := share_at_most).
assert (0 <= 1 - dx * dx <= 1) by nra.
assert (- (1 - dx * dx) <= fx * (1 - dx * dx) <= 1 - dx * dx) by nra.
assert (- dy <= fy * dy <= dy) by nra. assert (- dz <= fz * dz <= dz) by nra.
assert (- (dx * (dy + dz)) <= dx * (fy * dy + fz * dz) <= dx * (dy + dz)) by nra.
assert (Q6 := square_at_least_0 (dy - dz)).
assert (Q7 := square_at_least_0 (2.732 * dx - (dy + dz))). nra.
Qed.

End Direction.

(* Cauchy's inequality. *)
Lemma product_of_lengths a b c x y z :
  a * a + (b * b + c * c) <= 1 -> x * x + (y * y + z * z) <= 1 -> -1 <= a * x + (b * y + c * z) <= 1.
Proof.
intros H K. assert (Q : (a * x + (b * y + c * z)) * (a * x + (b * y + c * z)) <= 1).
{ assert (Q8 := square_at_least_0 (a * y - b * x)). assert (Q9 := square_at_least_0 (a * z - c * x)).
  assert (Q10 := square_at_least_0 (b * z - c * y)).
  assert ((a * a + (b * b + c * c)) * (x * x + (y * y + z * z)) <= 1) by nra. nra. }
nra.
Qed.
