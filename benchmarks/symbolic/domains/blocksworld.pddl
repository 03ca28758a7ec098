; A hand rearranges towers of blocks on a table.
;@ skill pick-up 0 pick ?b
;@ skill unstack 0 pick ?b
;@ skill put-down 0 lay ?b
;@ skill stack 0 place ?b ?under
(define (domain blocksworld)
 (:requirements :strips :typing)
 (:types block)
 (:predicates (on ?b ?under - block) (on-table ?b - block) (clear ?b - block) (holding ?b - block) (hand-empty))
 (:action pick-up
  :parameters (?b - block)
  :precondition (and (on-table ?b) (clear ?b) (hand-empty))
  :effect (and (holding ?b) (not (on-table ?b)) (not (clear ?b)) (not (hand-empty))))
 (:action put-down
  :parameters (?b - block)
  :precondition (and (holding ?b))
  :effect (and (on-table ?b) (clear ?b) (hand-empty) (not (holding ?b))))
 (:action stack
  :parameters (?b ?under - block)
  :precondition (and (holding ?b) (clear ?under))
  :effect (and (on ?b ?under) (clear ?b) (hand-empty) (not (holding ?b)) (not (clear ?under))))
 (:action unstack
  :parameters (?b ?under - block)
  :precondition (and (on ?b ?under) (clear ?b) (hand-empty))
  :effect (and (holding ?b) (clear ?under) (not (on ?b ?under)) (not (clear ?b)) (not (hand-empty)))))
