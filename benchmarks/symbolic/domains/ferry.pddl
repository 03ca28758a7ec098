; A ferry takes cars over, one at a time.
;@ skill sail 0 sail ?to
;@ skill board 0 board ?c
;@ skill debark 0 debark ?c
(define (domain ferry)
 (:requirements :strips :typing)
 (:types car port)
 (:predicates (at-ferry ?p - port) (at ?c - car ?p - port) (empty-ferry) (aboard ?c - car))
 (:action sail
  :parameters (?from ?to - port)
  :precondition (and (at-ferry ?from))
  :effect (and (at-ferry ?to) (not (at-ferry ?from))))
 (:action board
  :parameters (?c - car ?p - port)
  :precondition (and (at ?c ?p) (at-ferry ?p) (empty-ferry))
  :effect (and (aboard ?c) (not (at ?c ?p)) (not (empty-ferry))))
 (:action debark
  :parameters (?c - car ?p - port)
  :precondition (and (aboard ?c) (at-ferry ?p))
  :effect (and (at ?c ?p) (empty-ferry) (not (aboard ?c)))))
