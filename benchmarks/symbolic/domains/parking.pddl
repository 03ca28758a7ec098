; Cars at kerbs, double-parked one deep, are rearranged.
;@ skill kerb-to-kerb 0 to-kerb ?c ?to
;@ skill car-to-kerb 0 to-kerb ?c ?to
;@ skill kerb-to-car 0 to-car ?c ?other
;@ skill car-to-car 0 to-car ?c ?other
(define (domain parking)
 (:requirements :strips :typing)
 (:types car kerb)
 (:predicates (at-kerb ?c - car) (parked ?c - car ?k - kerb) (behind ?c ?front - car) (car-clear ?c - car)
  (kerb-clear ?k - kerb))
 (:action kerb-to-kerb
  :parameters (?c - car ?from ?to - kerb)
  :precondition (and (car-clear ?c) (kerb-clear ?to) (parked ?c ?from))
  :effect (and (parked ?c ?to) (kerb-clear ?from) (not (kerb-clear ?to)) (not (parked ?c ?from))))
 (:action car-to-kerb
  :parameters (?c - car ?front - car ?to - kerb)
  :precondition (and (car-clear ?c) (kerb-clear ?to) (behind ?c ?front))
  :effect (and (parked ?c ?to) (at-kerb ?c) (car-clear ?front) (not (kerb-clear ?to)) (not (behind ?c ?front))))
 (:action kerb-to-car
  :parameters (?c - car ?from - kerb ?other - car)
  :precondition (and (car-clear ?c) (car-clear ?other) (parked ?c ?from) (at-kerb ?c) (at-kerb ?other))
  :effect (and (behind ?c ?other) (kerb-clear ?from) (not (car-clear ?other)) (not (parked ?c ?from))
   (not (at-kerb ?c))))
 (:action car-to-car
  :parameters (?c ?front ?other - car)
  :precondition (and (car-clear ?c) (car-clear ?other) (behind ?c ?front) (at-kerb ?other))
  :effect (and (behind ?c ?other) (car-clear ?front) (not (car-clear ?other)) (not (behind ?c ?front)))))
