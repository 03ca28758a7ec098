; Discs move between pegs, never onto a smaller disc.
;@ skill move 0 move ?d ?to
(define (domain hanoi)
 (:requirements :strips :typing)
 (:types spot - object disc peg - spot)
 (:predicates (on ?d - disc ?s - spot) (clear ?s - spot) (smaller ?d - disc ?s - spot))
 (:action move
  :parameters (?d - disc ?from ?to - spot)
  :precondition (and (on ?d ?from) (clear ?d) (clear ?to) (smaller ?d ?to))
  :effect (and (on ?d ?to) (clear ?from) (not (on ?d ?from)) (not (clear ?to)))))
