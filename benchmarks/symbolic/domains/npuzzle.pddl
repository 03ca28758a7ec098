; Slide tiles into the gap.
;@ skill slide 0 slide ?t
(define (domain npuzzle)
 (:requirements :strips :typing)
 (:types tile cell)
 (:predicates (at ?t - tile ?c - cell) (gap ?c - cell) (beside ?a ?b - cell))
 (:action slide
  :parameters (?t - tile ?from ?to - cell)
  :precondition (and (at ?t ?from) (gap ?to) (beside ?from ?to))
  :effect (and (at ?t ?to) (gap ?from) (not (at ?t ?from)) (not (gap ?to)))))
