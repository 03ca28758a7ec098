; A robot visits cells of a floor plan.
;@ skill move 0 move ?to
(define (domain visitall)
 (:requirements :strips :typing)
 (:types cell)
 (:predicates (robot-at ?c - cell) (visited ?c - cell) (beside ?a ?b - cell))
 (:action move
  :parameters (?from ?to - cell)
  :precondition (and (robot-at ?from) (beside ?from ?to))
  :effect (and (robot-at ?to) (visited ?to) (not (robot-at ?from)))))
