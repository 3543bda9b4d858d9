(* What    Kahan's difference of products, as common/math.clh computes it, has the sign of the exact a*b - c*d: in every
           binary format with gradual underflow and rounding to nearest, ties to even, where neither product is so small
           that its rounding error isn't a float.
   Why     It is what is watertight about the triangle's test (watertight.v).
   Shape   e is exact, so f + e can only have the wrong sign by being 0: f would have to be -e. Then a*b - c*d is no more
           than half of e's last place, which is less than the last place of either product; but it is a multiple of that.
   Source  The bound on the relative error, of which this is a part: Jeannerod, Louvet, Muller, Math. Comp. 2013. *)
Require Import Reals ZArith Lia Lra Psatz.
From Flocq Require Import Core Plus_error Mult_error.

Open Scope R_scope.

Section Kahan.

Variables emin prec : Z.
Hypothesis at_least_two_bits : (1 < prec)%Z.

Notation exponent := (FLT_exp emin prec).
Notation float := (generic_format radix2 exponent).
Notation pow := (bpow radix2).
Definition nearest := round radix2 exponent ZnearestE.

Local Instance prec_positive : Prec_gt_0 prec.
Proof. unfold Prec_gt_0. lia. Qed.

Definition kahan a b c d :=
  let w := nearest (c * d) in
  let e := nearest (- c * d + w) in
  let f := nearest (a * b + - w) in
  nearest (f + e).

Definition no_underflow x := x = 0 \/ pow (emin + 2 * prec - 1) <= Rabs x.

Lemma nearest_float x : float x -> nearest x = x.
Proof. intros H. apply round_generic; auto with typeclass_instances. Qed.

Lemma nearest_is_float x : float (nearest x).
Proof. apply generic_format_round; auto with typeclass_instances. Qed.

Lemma nearest_opp x : nearest (- x) = - nearest x.
Proof. apply round_NE_opp. Qed.

Lemma nearest_le x y : x <= y -> nearest x <= nearest y.
Proof. apply round_le; auto with typeclass_instances. Qed.

Lemma nearest_0 : nearest 0 = 0.
Proof. apply round_0; auto with typeclass_instances. Qed.

(* A float is a whole number of less than prec bits times a power of two. *)
Lemma float_parts a : float a ->
  exists m k, a = IZR m * pow k /\ (Z.abs m <= 2 ^ prec - 1)%Z /\ (emin <= k)%Z.
Proof.
intros Ha. apply FLT_format_generic in Ha; auto with typeclass_instances.
destruct Ha as [[m k] H1 H2 H3]. exists m, k. simpl in *.
split; [exact H1|]. split; [|exact H3].
change (Zpower radix2 prec) with (2 ^ prec)%Z in H2. lia.
Qed.

(* So a product of two is one of less than 2 prec bits. *)
Lemma product_parts a b : float a -> float b ->
  exists m k, a * b = IZR m * pow k /\ (Z.abs m <= (2 ^ prec - 1) * (2 ^ prec - 1))%Z.
Proof.
intros Ha Hb.
destruct (float_parts a Ha) as (ma & ka & -> & Ma & _).
destruct (float_parts b Hb) as (mb & kb & -> & Mb & _).
exists (ma * mb)%Z, (ka + kb)%Z. split.
- rewrite mult_IZR, bpow_plus. ring.
- rewrite Z.abs_mul. apply Z.mul_le_mono_nonneg; lia.
Qed.

(* What isn't 0 is at least the smaller of its terms' last places. *)
Lemma difference_at_least m k n l :
  IZR m * pow k - IZR n * pow l <> 0 ->
  pow (Z.min k l) <= Rabs (IZR m * pow k - IZR n * pow l).
Proof.
intros H. set (j := Z.min k l) in *.
assert (E : IZR m * pow k - IZR n * pow l = IZR (m * 2 ^ (k - j) - n * 2 ^ (l - j)) * pow j).
{ rewrite minus_IZR, !mult_IZR.
  change 2%Z with (radix_val radix2).
  rewrite !IZR_Zpower by (unfold j; lia).
  replace (pow k) with (pow (k - j) * pow j) by (rewrite <- bpow_plus; f_equal; ring).
  replace (pow l) with (pow (l - j) * pow j) by (rewrite <- bpow_plus; f_equal; ring).
  ring. }
rewrite E in *. set (n' := (m * 2 ^ (k - j) - n * 2 ^ (l - j))%Z) in *.
rewrite Rabs_mult, (Rabs_pos_eq (pow j)) by apply bpow_ge_0.
assert (n' <> 0)%Z. { intros ->. apply H. ring. }
rewrite <- (Rmult_1_l (pow j)) at 1. apply Rmult_le_compat_r. apply bpow_ge_0.
rewrite <- abs_IZR. apply IZR_le. lia.
Qed.


Lemma product_below m k :
  (Z.abs m <= (2 ^ prec - 1) * (2 ^ prec - 1))%Z ->
  Rabs (IZR m * pow k) <= (pow prec - 1) * (pow prec - 1) * pow k.
Proof.
intros H. rewrite Rabs_mult, (Rabs_pos_eq (pow k)) by apply bpow_ge_0.
apply Rmult_le_compat_r. apply bpow_ge_0.
rewrite <- abs_IZR. apply IZR_le in H.
rewrite mult_IZR, minus_IZR in H.
change 2%Z with (radix_val radix2) in H. rewrite IZR_Zpower in H by lia. exact H.
Qed.

(* The sum that the second rounding leaves is 0 only where the difference is. *)
Lemma last_sum_not_0 a b c d :
  float a -> float b -> float c -> float d ->
  c * d <> 0 -> pow (emin + 2 * prec - 1) <= Rabs (c * d) -> a * b - c * d <> 0 ->
  nearest (a * b - nearest (c * d)) + (nearest (c * d) - c * d) <> 0.
Proof.
intros Fa Fb Fc Fd N U X S.
set (w := nearest (c * d)) in *. set (f := nearest (a * b - w)) in *.
set (M := mag radix2 (c * d) : Z).
assert (Hlow : pow (M - 1) <= Rabs (c * d)) by (apply bpow_mag_le; exact N).
assert (Hhigh : Rabs (c * d) < pow M) by apply bpow_mag_gt.
assert (HM : (emin + 2 * prec <= M)%Z).
{ assert (pow (emin + 2 * prec - 1) < pow M) by lra. apply lt_bpow in H. lia. }
(* w is off by half a last place of c*d ... *)
assert (He : Rabs (w - c * d) <= pow (M - prec - 1)).
{ eapply Rle_trans. apply error_le_half_ulp; auto with typeclass_instances.
  rewrite ulp_neq_0 by exact N. unfold cexp, FLT_exp. fold M. rewrite Z.max_l by lia.
  assert (D : pow (M - prec) = 2 * pow (M - prec - 1)) by (rewrite <- (bpow_plus_1 radix2); f_equal; ring).
  lra. }
(* ... and f, which would be that, by half of its own. *)
assert (Hx : Rabs (a * b - c * d) <= pow (M - 2 * prec - 1)).
{ replace (a * b - c * d) with (- (f - (a * b - w))) by lra. rewrite Rabs_Ropp.
  eapply Rle_trans. apply error_le_half_ulp_round; auto with typeclass_instances.
  fold (nearest (a * b - w)). fold f. replace f with (- (w - c * d)) by lra. rewrite ulp_opp.
  assert (ulp radix2 exponent (w - c * d) <= ulp radix2 exponent (pow (M - prec - 1))).
  { apply ulp_le; auto with typeclass_instances. rewrite (Rabs_pos_eq (pow _)) by apply bpow_ge_0. exact He. }
  assert (E : exponent (M - prec - 1 + 1)%Z = (M - 2 * prec - 1 + 1)%Z) by (unfold FLT_exp; lia).
  rewrite ulp_bpow, E, bpow_plus_1 in H. change (IZR radix2) with 2 in H. lra. }
destruct (product_parts a b Fa Fb) as (m & k & Eab & Bm).
destruct (product_parts c d Fc Fd) as (n & l & Ecd & Bn).
apply product_below with (k := k) in Bm. rewrite <- Eab in Bm.
apply product_below with (k := l) in Bn. rewrite <- Ecd in Bn.
assert (P : 2 < pow prec).
{ change 2 with (pow 1). apply bpow_lt. lia. }
assert (Pl := bpow_gt_0 radix2 l). assert (Pk := bpow_gt_0 radix2 k).
assert (Pm := bpow_gt_0 radix2 (M - 2 * prec - 1)).
(* Both products' last places are above that. *)
assert (Hl : (M - 2 * prec <= l)%Z).
{ assert (pow (M - 1) < pow (2 * prec + l)).
  { replace (2 * prec + l)%Z with (prec + prec + l)%Z by ring. rewrite !bpow_plus.
    eapply Rle_lt_trans. exact Hlow. eapply Rle_lt_trans. exact Bn.
    apply Rmult_lt_compat_r. exact Pl. nra. }
  apply lt_bpow in H. lia. }
assert (Hk : (M - 2 * prec <= k)%Z).
{ destruct (Z_le_gt_dec (M - 2 * prec) k) as [H|H]; [exact H|exfalso].
  assert (pow k <= pow (M - 2 * prec - 1)) by (apply bpow_le; lia).
  assert (pow (M - 1) = pow prec * pow prec * pow (M - 2 * prec - 1)).
  { rewrite <- !bpow_plus. f_equal. ring. }
  assert (Rabs (c * d) - Rabs (a * b - c * d) <= Rabs (a * b)).
  { assert (T := Rabs_triang (a * b) (- (a * b - c * d))). rewrite Rabs_Ropp in T.
    replace (a * b + - (a * b - c * d)) with (c * d) in T by ring. lra. }
  assert (Rabs (a * b) <= (pow prec - 1) * (pow prec - 1) * pow (M - 2 * prec - 1)).
  { eapply Rle_trans. exact Bm. apply Rmult_le_compat_l. nra. lra. }
  nra. }
(* But the difference is a multiple of the smaller one. *)
assert (H := difference_at_least m k n l).
rewrite <- Eab, <- Ecd in H. specialize (H X).
assert (pow (M - 2 * prec - 1) < pow (Z.min k l)) by (apply bpow_lt; lia).
lra.
Qed.

Lemma nearest_not_0 x : pow emin <= Rabs x -> nearest x <> 0.
Proof.
intros H.
assert (E : float (pow emin)).
{ apply generic_format_bpow. unfold FLT_exp. lia. }
assert (Q := bpow_gt_0 radix2 emin).
unfold Rabs in H. destruct (Rcase_abs x) as [L|L].
- assert (nearest x <= nearest (- pow emin)) by (apply nearest_le; lra).
  rewrite nearest_opp, (nearest_float _ E) in H0. lra.
- assert (nearest (pow emin) <= nearest x) by (apply nearest_le; lra).
  rewrite (nearest_float _ E) in H0. lra.
Qed.

Lemma kahan_positive a b c d :
  float a -> float b -> float c -> float d -> no_underflow (a * b) -> no_underflow (c * d) ->
  0 < a * b - c * d -> 0 < kahan a b c d.
Proof.
intros Fa Fb Fc Fd Uab Ucd X. unfold kahan.
set (w := nearest (c * d)). replace (- c * d + w) with (w - c * d) by ring.
replace (a * b + - w) with (a * b - w) by ring.
destruct Ucd as [Z|U].
- (* c*d = 0: what is left is a*b. *)
  unfold w. rewrite Z, nearest_0. replace (0 - 0) with 0 by ring. rewrite nearest_0.
  rewrite Rminus_0_r, Rplus_0_r, nearest_float by apply nearest_is_float.
  assert (nearest (a * b) <> 0).
  { apply nearest_not_0. destruct Uab as [A|A]; [lra|].
    eapply Rle_trans. 2: exact A. apply bpow_le. lia. }
  assert (nearest 0 <= nearest (a * b)) by (apply nearest_le; lra).
  rewrite nearest_0 in H0. lra.
- assert (N : c * d <> 0).
  { intros E. rewrite E, Rabs_R0 in U. assert (Q := bpow_gt_0 radix2 (emin + 2 * prec - 1)). lra. }
  assert (Fe : float (w - c * d)).
  { apply mult_error_FLT; auto with typeclass_instances. }
  rewrite (nearest_float _ Fe).
  set (f := nearest (a * b - w)).
  assert (S : f + (w - c * d) <> 0) by (apply last_sum_not_0; auto; lra).
  assert (- (w - c * d) <= f).
  { rewrite <- (nearest_float (- (w - c * d))) by (apply generic_format_opp; exact Fe).
    apply nearest_le. lra. }
  assert (nearest (f + (w - c * d)) <> 0).
  { apply round_plus_neq_0; auto with typeclass_instances. apply nearest_is_float. }
  assert (nearest 0 <= nearest (f + (w - c * d))) by (apply nearest_le; lra).
  rewrite nearest_0 in H1. lra.
Qed.

Lemma kahan_opp a b c d : kahan (- a) b (- c) d = - kahan a b c d.
Proof.
unfold kahan.
replace (nearest (- c * d)) with (- nearest (c * d)) by (rewrite <- (nearest_opp (c * d)); f_equal; ring).
generalize (nearest (c * d)). intros w.
replace (nearest (- - c * d + - w)) with (- nearest (- c * d + w)) by (rewrite <- (nearest_opp (- c * d + w)); f_equal; ring).
replace (nearest (- a * b + - - w)) with (- nearest (a * b + - w)) by (rewrite <- (nearest_opp (a * b + - w)); f_equal; ring).
rewrite <- (nearest_opp (nearest (a * b + - w) + nearest (- c * d + w))). f_equal. ring.
Qed.

Lemma kahan_0 a b c d :
  float c -> float d -> no_underflow (c * d) -> a * b - c * d = 0 -> kahan a b c d = 0.
Proof.
intros Fc Fd U X. unfold kahan. set (w := nearest (c * d)).
assert (Fe : float (w - c * d)).
{ apply mult_error_FLT; auto with typeclass_instances. intros N.
  destruct U as [Z|U]; [contradiction|exact U]. }
replace (- c * d + w) with (w - c * d) by ring. rewrite (nearest_float _ Fe).
replace (a * b + - w) with (- (w - c * d)) by lra.
rewrite (nearest_float (- _)) by (apply generic_format_opp; exact Fe).
replace (- (w - c * d) + (w - c * d)) with 0 by ring. apply nearest_0.
Qed.

Definition sign x := Rcompare x 0.

(* Kahan's difference of products has the sign of the exact difference. *)
Theorem kahan_sign a b c d :
  float a -> float b -> float c -> float d -> no_underflow (a * b) -> no_underflow (c * d) ->
  sign (kahan a b c d) = sign (a * b - c * d).
Proof.
intros Fa Fb Fc Fd Uab Ucd. unfold sign.
destruct (Rcompare_spec (a * b - c * d) 0) as [X|X|X].
- apply Rcompare_Lt.
  assert (0 < kahan (- a) b (- c) d).
  { apply kahan_positive; auto using generic_format_opp.
    - destruct Uab as [A|A]; [left; lra|right]. rewrite Ropp_mult_distr_l_reverse, Rabs_Ropp. exact A.
    - destruct Ucd as [A|A]; [left; lra|right]. rewrite Ropp_mult_distr_l_reverse, Rabs_Ropp. exact A.
    - lra. }
  rewrite kahan_opp in H. lra.
- apply Rcompare_Eq. apply kahan_0; auto; lra.
- apply Rcompare_Gt. apply kahan_positive; auto; lra.
Qed.

End Kahan.
