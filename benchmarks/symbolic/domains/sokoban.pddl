; A keeper pushes boxes over a floor of cells; nothing can be pulled.
;@ skill walk 0 walk ?to
;@ skill push 0 push ?b ?to
(define (domain sokoban)
 (:requirements :strips :typing)
 (:types cell box)
 (:predicates (keeper-at ?c - cell) (box-at ?b - box ?c - cell) (vacant ?c - cell) (beside ?a ?b - cell)
  (in-line ?a ?b ?c - cell))
 (:action walk
  :parameters (?from ?to - cell)
  :precondition (and (keeper-at ?from) (beside ?from ?to) (vacant ?to))
  :effect (and (keeper-at ?to) (vacant ?from) (not (keeper-at ?from)) (not (vacant ?to))))
 (:action push
  :parameters (?b - box ?here ?at ?to - cell)
  :precondition (and (keeper-at ?here) (box-at ?b ?at) (in-line ?here ?at ?to) (vacant ?to))
  :effect (and (keeper-at ?at) (box-at ?b ?to) (vacant ?here) (not (keeper-at ?here)) (not (box-at ?b ?at))
   (not (vacant ?to)))))
