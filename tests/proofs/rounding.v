(* What    What bounds take an operation on floats for (bound.py): its exact result times 1 + e, plus n, which is 0 for sums;
           |e| <= 2^-24, |n| <= 2^-150. Overflow is not considered: coordinates are below 2^61. *)
Require Import Reals ZArith Lra Lia.
From Flocq Require Import Core Relative Plus_error.
Open Scope R_scope.

Notation float := (generic_format radix2 (FLT_exp (-149) 24)).
Notation nearest := (round radix2 (FLT_exp (-149) 24) ZnearestE).
Local Instance prec_positive : Prec_gt_0 24 := eq_refl.

Lemma half_of_last_place : / 2 * bpow radix2 (Z.opp 24 + 1) = bpow radix2 (-24).
Proof. rewrite bpow_plus_1. change (IZR radix2) with 2. change (Z.opp 24) with (-24)%Z. lra. Qed.

Theorem operation x :
  exists e n, Rabs e <= bpow radix2 (-24) /\ Rabs n <= bpow radix2 (-150) /\ nearest x = x * (1 + e) + n.
Proof.
destruct (error_N_FLT radix2 (-149) 24 eq_refl (fun x => negb (Z.even x)) x) as (e & n & He & Hn & _ & H).
exists e, n. rewrite half_of_last_place in He.
replace (/ 2 * bpow radix2 (-149)) with (bpow radix2 (-150)) in Hn; [auto|].
change (-149)%Z with (-150 + 1)%Z. rewrite bpow_plus_1. change (IZR radix2) with 2. lra.
Qed.

Theorem sum x y : float x -> float y ->
  exists e, Rabs e <= bpow radix2 (-24) /\ nearest (x + y) = (x + y) * (1 + e).
Proof.
intros Fx Fy. destruct (Rle_or_lt (bpow radix2 (-149 + 24 - 1)) (Rabs (x + y))) as [L|S].
- destruct (relative_error_N_FLT_ex radix2 (-149) 24 eq_refl (fun x => negb (Z.even x)) (x + y) L) as (e & He & H).
  exists e. rewrite half_of_last_place in He. auto.
- exists 0. split; [rewrite Rabs_R0; apply bpow_ge_0|].
  rewrite Rplus_0_r, Rmult_1_r. apply round_generic; auto with typeclass_instances.
  apply FLT_format_plus_small; auto with typeclass_instances.
  apply Rlt_le, Rlt_trans with (1 := S). apply bpow_lt. lia.
Qed.
