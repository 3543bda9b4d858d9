(* What    Two triangles that share an edge see opposite signs of its edge function, each as computed, wherever the edge
           stands among a triangle's corners. KernelSource is printed from the kernels' source (signs.kernel).
   Shape   side P Q is the edge function from P to Q: of the corners as the ray's shear puts them, which depends on a
           corner and the ray alone. wa, wb and wc are the sides from b to c, c to a and a to b, by definition: each
           `reflexivity` fails when the source computes them otherwise. *)
Require Import Reals ZArith Lra Lia.
From Flocq Require Import Core.
Require Import kahan KernelSource.
Open Scope R_scope.

Section Watertight.

Variables emin prec : Z.
Hypothesis at_least_two_bits : (1 < prec)%Z.
Notation float := (generic_format radix2 (FLT_exp emin prec)).
Notation nearest := (nearest emin prec).

(* A corner less the ray's origin, with the direction's largest axis last. *)
Record corner := { x : R; y : R; z : R }.

Variables sx sy : R.
Definition across (p : corner) := nearest (- sx * z p + x p).
Definition up (p : corner) := nearest (- sy * z p + y p).

Definition side p q := kahan emin prec (across q) (up p) (up q) (across p).

Notation of_corners w := (fun a b c => w nearest (x a) (y a) (z a) (x b) (y b) (z b) (x c) (y c) (z c) sx sy).

Lemma wa_is_a_side a b c : of_corners wa a b c = side b c.
Proof. reflexivity. Qed.
Lemma wb_is_a_side a b c : of_corners wb a b c = side c a.
Proof. reflexivity. Qed.
Lemma wc_is_a_side a b c : of_corners wc a b c = side a b.
Proof. reflexivity. Qed.

(* Products are 0 or no smaller than 2^-102 in binary32. *)
Definition large_enough p q := no_underflow emin prec (across p * up q).

(* The sign is that of the exact edge function of the projected corners. *)
Theorem side_is_exact p q : large_enough p q -> large_enough q p ->
  sign (side p q) = sign (across q * up p - up q * across p).
Proof.
intros Hp Hq. unfold large_enough in Hp. rewrite Rmult_comm in Hp.
apply kahan_sign; try apply nearest_is_float; assumption.
Qed.

Theorem opposite_signs p q : large_enough p q -> large_enough q p -> sign (side q p) = CompOpp (sign (side p q)).
Proof.
intros Hp Hq. rewrite !side_is_exact by assumption. unfold sign.
set (d := across q * up p - up q * across p).
replace (across p * up q - up p * across q) with (- d) by (unfold d; ring).
destruct (Rcompare_spec d 0) as [H|H|H].
- apply Rcompare_Gt. lra.
- apply Rcompare_Eq. lra.
- apply Rcompare_Lt. lra.
Qed.

End Watertight.

(* In the precisions that kdray has. *)
Definition opposite_signs_in_float := opposite_signs (-149) 24 eq_refl.
Definition opposite_signs_in_double := opposite_signs (-1074) 53 eq_refl.
Print Assumptions opposite_signs_in_float.
